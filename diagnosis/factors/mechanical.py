"""The mechanical causes that would make the same curve as the fitted electrical ones, for the magnet that is there.

Gain mismatch and phase together are a counter-rotating component of the field as sensed; a sensor off the shaft's
axis, or tilted, makes one too. An offset is what a stray field makes. None of these can be told apart on one turn at
one air gap, so the figures are equivalents, not findings.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from diagnosis.error_model.model import BETA, GAIN, VX, VY
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors.modulus import modulus_interval
from diagnosis.factors.mounting import Mounting, coefficients
from twin.angles import Array
from twin.confidence import Z95
from twin.magnet.magnet import Magnet
from twin.magnet.placement import LARGEST_GAP_MM, SMALLEST_GAP_MM
from twin.magnet.stray_field import FIELD_MT

_NODES = 201
_LARGEST_SHARE_OF_REACH = 2.0 / 3.0
_LARGEST_TILT_DEG = 45.0
_STEP = 1e-6


@dataclass(frozen=True, kw_only=True)
class Mechanical:
    """Equivalents of one fitted point, with 95 % intervals. None where the magnet's field reaches no such share."""

    off_axis_mm: float | None
    """Sensor off the axis, untilted."""
    off_axis_low_mm: float | None
    off_axis_high_mm: float | None
    off_axis_direction_deg: float
    """From the sensor's x axis; this and the opposite direction make the same curve."""
    tilt_deg: float | None
    """Tilt of the sensor, on the axis."""
    tilt_low_deg: float | None
    tilt_high_deg: float | None
    tilt_direction_deg: float
    stray_x_mT: float
    stray_x_half_mT: float
    """Half width of its 95 % interval."""
    stray_y_mT: float
    stray_y_half_mT: float
    field_mT: float
    """Field of the magnet that the stray field is counted against."""
    order_2_deg: float
    """Amplitude of the angle error of order 2 that all three stand for."""
    magnet: str
    """The magnet that millimetres are counted for, in words."""
    air_gap_mm: float
    assumed: bool
    """Nobody has named a magnet."""


def counter_rotating(point: Array) -> complex:
    """The counter-rotating share of x + iy, in the axes in which the main part is real and positive.

    x = cos a, y = g sin(a + beta) gives (1 + g e^(i beta))/2 forwards and (1 - g e^(-i beta))/2 backwards.
    """
    gain, beta = float(point[GAIN]), float(point[BETA])
    forwards = (1.0 + gain * np.exp(1j * beta)) / 2.0
    backwards = (1.0 - gain * np.exp(-1j * beta)) / 2.0
    return complex(backwards * forwards / abs(forwards) ** 2)


def mechanical(fit: BaselineFit, mounting: Mounting | None = None, gap_mm: float | None = None) -> Mechanical:
    """Equivalents of a fit for this magnet at this air gap; without them for the magnet that the twin assumes."""
    place = mounting or Mounting.unstated()
    gap = place.air_gap_mm[0] if gap_mm is None else float(gap_mm)
    # The twin counts a stray field against a field of its own where no magnet is described.
    field = FIELD_MT if place.assumed else float(place.field_mT(np.array([gap]))[0])
    share = counter_rotating(fit.point)
    half = (fit.high - fit.low) / 2.0
    ends = (abs(share), *modulus_interval(abs(share), _share_error(fit)))
    shift, shift_low, shift_high = _off_axis(place, gap, ends)
    tilt, tilt_low, tilt_high = (_solve(_shares(place.magnet, gap, "sensor_tilt_y_deg"), end) for end in ends)
    towards = 0.5 * float(np.degrees(np.angle(share)))
    return Mechanical(
        off_axis_mm=shift,
        off_axis_low_mm=shift_low,
        off_axis_high_mm=shift_high,
        off_axis_direction_deg=_half_turn(towards, _shares(place.magnet, gap, "sensor_x_mm")),
        tilt_deg=tilt,
        tilt_low_deg=tilt_low,
        tilt_high_deg=tilt_high,
        tilt_direction_deg=_half_turn(towards, _shares(place.magnet, gap, "sensor_tilt_y_deg")),
        stray_x_mT=float(fit.point[VX]) * field,
        stray_x_half_mT=float(half[VX]) * field,
        stray_y_mT=float(fit.point[VY]) * field,
        stray_y_half_mT=float(half[VY]) * field,
        field_mT=field,
        order_2_deg=float(np.degrees(abs(share))),
        magnet=place.body,
        air_gap_mm=gap,
        assumed=place.assumed,
    )


def _off_axis(
    place: Mounting, gap: float, shares: tuple[float, ...]
) -> tuple[float | None, float | None, float | None]:
    """The displacement of a share, and those of the ends of its interval, widened by what the air gap leaves open."""
    value, low, high = (_solve(_shares(place.magnet, gap, "sensor_x_mm"), share) for share in shares)
    if place.assumed or value is None:
        return value, low, high
    reach = Z95 * place.gap_error_mm
    beside = [
        _solve(_shares(place.magnet, gap + far, "sensor_x_mm"), shares[0])
        for far in (-reach, reach)
        if SMALLEST_GAP_MM <= gap + far <= LARGEST_GAP_MM
    ]
    spread = [abs(one - value) for one in beside if one is not None]
    lost = len(spread) < 2
    wide = max(spread, default=0.0)
    return (
        value,
        None if low is None else max(value - float(np.hypot(value - low, wide)), 0.0),
        None if high is None or lost else value + float(np.hypot(high - value, wide)),
    )


def _share_error(fit: BaselineFit) -> float:
    """The larger standard error of the counter-rotating share among its directions."""
    rows = [GAIN, BETA]
    slopes = np.zeros((2, 2))
    for column, row in enumerate(rows):
        moved = fit.point.copy()
        moved[row] += _STEP
        change = (counter_rotating(moved) - counter_rotating(fit.point)) / _STEP
        slopes[:, column] = change.real, change.imag
    own = slopes @ fit.covariance[np.ix_(rows, rows)] @ slopes.T
    return float(np.sqrt(max(np.linalg.eigvalsh(own)[-1], 0.0)))


@lru_cache(maxsize=128)
def _shares(magnet: Magnet, gap_mm: float, name: str) -> tuple[Array, Array]:
    """Displacements [mm] or tilts [deg] (nodes,) and the signed counter-rotating share that each makes, while it grows.

    With the field's gains along and across the direction of the displacement, it is their difference over their sum.
    """
    largest = _LARGEST_TILT_DEG if "tilt" in name else _LARGEST_SHARE_OF_REACH * float(magnet.reach_mm)
    value = np.linspace(0.0, largest, _NODES)
    field = coefficients(magnet, np.full(_NODES, gap_mm), **{name: value})
    along, across = field[:, 0, 1], field[:, 1, 2]
    shares = np.asarray((along - across) / (along + across))
    back = np.flatnonzero(np.diff(np.abs(shares)) < 0.0)
    grown = _NODES if not back.size else int(back[0]) + 1
    return value[:grown], shares[:grown]


def _solve(table: tuple[Array, Array], share: float) -> float | None:
    """The displacement or tilt that makes a share of this size."""
    value, shares = table
    if abs(shares[-1]) < share:
        return None
    # The share grows with the square, so its root is nearly straight in the displacement.
    return float(np.interp(np.sqrt(share), np.sqrt(np.abs(shares)), value))


def _half_turn(towards_deg: float, table: tuple[Array, Array]) -> float:
    """Direction [deg] in [0, 180) of the displacement or tilt; one that makes a negative share lies across."""
    return float((towards_deg + (0.0 if table[1][-1] > 0.0 else 90.0)) % 180.0)
