"""The mechanical causes that would make the same curve as the fitted electrical ones, for the twin's own magnet.

Gain mismatch and phase together are a counter-rotating component of the field as sensed; a sensor off the shaft's
axis, or tilted, makes one too. An offset is what a stray field makes. None of these can be told apart on one turn at
one air gap, so the figures are equivalents, not findings.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from diagnosis.error_model.model import BETA, GAIN, VX, VY
from twin.angles import Array
from twin.magnet.magnet_misalignment import MAGNET_MISALIGNMENT, tensor
from twin.magnet.stray_field import FIELD_MT

_NODES = 401


@dataclass(frozen=True)
class Mechanical:
    """Equivalents of one fitted point. None where no value within the twin's range reaches that far."""

    off_axis_mm: float | None
    """Sensor off the axis, untilted."""
    off_axis_direction_deg: float
    """From the sensor's x axis; this and the opposite direction make the same curve."""
    tilt_deg: float | None
    """Tilt of the sensor, on the axis."""
    tilt_direction_deg: float
    stray_x_mT: float
    stray_y_mT: float
    field_mT: float
    """Field of the magnet that the stray field is counted against."""
    order_2_deg: float
    """Amplitude of the angle error of order 2 that all three stand for."""


def counter_rotating(point: Array) -> complex:
    """The counter-rotating share of x + iy, in the axes in which the main part is real and positive.

    x = cos a, y = g sin(a + beta) gives (1 + g e^(i beta))/2 forwards and (1 - g e^(-i beta))/2 backwards.
    """
    gain, beta = float(point[GAIN]), float(point[BETA])
    forwards = (1.0 + gain * np.exp(1j * beta)) / 2.0
    backwards = (1.0 - gain * np.exp(-1j * beta)) / 2.0
    return complex(backwards * forwards / abs(forwards) ** 2)


def mechanical(point: Array, *, field_mT: float = FIELD_MT) -> Mechanical:
    """Equivalents of a point (6,) for the cylinder that the twin counts misalignment against."""
    share = counter_rotating(point)
    shift, shift_sign = _solve(abs(share), "off_axis_mm")
    tilt, tilt_sign = _solve(abs(share), "tilt_deg")
    towards = 0.5 * np.degrees(np.angle(share))
    return Mechanical(
        off_axis_mm=shift,
        off_axis_direction_deg=_half_turn(towards, shift_sign),
        tilt_deg=tilt,
        tilt_direction_deg=_half_turn(towards, tilt_sign),
        stray_x_mT=float(point[VX]) * field_mT,
        stray_y_mT=float(point[VY]) * field_mT,
        field_mT=field_mT,
        order_2_deg=float(np.degrees(abs(share))),
    )


@lru_cache(maxsize=2)
def _shares(name: str) -> tuple[Array, Array]:
    """Displacements [mm] or tilts [deg] (nodes,) and the signed counter-rotating share that each makes.

    With the field's gains along and across the direction of the displacement, it is their difference over their sum.
    """
    value = np.linspace(0.0, MAGNET_MISALIGNMENT.params[name].upper, _NODES)
    zero = np.zeros(_NODES)
    along, across = tensor(value, zero) if name == "off_axis_mm" else tensor(zero, value)
    return value, np.asarray((along - across) / (along + across))


def _solve(share: float, name: str) -> tuple[float | None, float]:
    """The displacement or tilt with this share, and the sign of the share it makes."""
    value, shares = _shares(name)
    sign = float(np.sign(shares[-1]))
    if abs(shares[-1]) < share:
        return None, sign
    # The share grows with the square, so its root is nearly straight in the displacement.
    return float(np.interp(np.sqrt(share), np.sqrt(np.maximum(sign * shares, 0.0)), value)), sign


def _half_turn(towards_deg: float, sign: float) -> float:
    """Direction [deg] in [0, 180) of the displacement or tilt; one that makes a negative share lies across."""
    return float((towards_deg + (0.0 if sign > 0 else 90.0)) % 180.0)
