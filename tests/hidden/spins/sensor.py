"""The sensor on a spun shaft: the tests' own chain, with further orders of the magnet, and its error at rest."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..baseline import Baseline, Injected
from ..chain import Bench, convert, field_channels
from ..motion import Motion, on_the_move
from ..noise import Noise
from ..word_causes import cordic
from .rotor import Array

AT_REST = frozenset({"saturation", "clipping", "multipole", "magnet_harmonic", "cordic_truncation", "adc_stuck_bit"})
"""Causes that are a function of the angle alone, whatever the time and the speed."""
GRID = 7200
PERFECT = Baseline(
    zero_deg=40.0,
    offset_x=0.0,
    offset_y=0.0,
    amplitude_x=1.0,
    amplitude_y=1.0,
    phase_deg=0.0,
    quadratic=0.0,
)
"""A sensor without an error, with a zero of its own."""


@dataclass(frozen=True)
class Order:
    """An order of the magnet's field beyond what its baseline brings."""

    order: int
    amplitude_deg: float
    phase_deg: float


def bent(shaft_deg: Array, orders: tuple[Order, ...]) -> Array:
    """The field's angle over the shaft's."""
    turned = shaft_deg.copy()
    for one in orders:
        turned = turned + one.amplitude_deg * np.sin(np.radians(one.order * shaft_deg + one.phase_deg))
    return turned


def motion_of(time_s: Array, shaft_deg: Array, speed_deg_s: Array, *, protocol: str) -> Motion:
    """The motion as the chain takes it."""
    speed = np.abs(speed_deg_s)
    step_deg = float(np.median(speed[1:] * np.diff(time_s))) if time_s.size > 1 else 1.0
    return on_the_move(
        protocol,
        time_s=time_s,
        shaft_deg=shaft_deg,
        speed_deg_s=speed_deg_s,
        points=int(np.clip(360.0 / max(step_deg, 0.1), 24, 3600)),
        turn=np.floor(np.abs(shaft_deg - shaft_deg[0]) / 360.0).astype(np.int64),
    )


@dataclass(frozen=True)
class AtRest:
    """Over an even grid of a turn, degrees, shape (GRID,) each."""

    shaft_deg: Array
    reading_deg: Array
    """Unwrapped."""

    @property
    def error_deg(self) -> Array:
        """What the reading is off, mean 0: the zero is nobody's to know."""
        off = self.reading_deg - self.shaft_deg
        return np.asarray(off - off.mean())


def at_rest(own: Baseline, causes: list[Injected], orders: tuple[Order, ...]) -> AtRest:
    """What the sensor says of a shaft that stands still, without noise, rounding and link."""
    shaft = 360.0 / GRID * np.arange(GRID)
    motion = motion_of(np.arange(GRID, dtype=np.float64), shaft, np.zeros(GRID), protocol="at_rest")
    motion = replace(motion, shaft_deg=bent(shaft, orders))
    acting = [one for one in causes if one.name in AT_REST]
    bench = Bench(motion, own, Noise("white", 0.0), 16, channels=False, channel_scale=1.0, channel_step=1e-9)
    x, y = convert(bench, field_channels(bench, acting), acting)
    told = np.degrees(np.arctan2(y, x))
    truncated = [one for one in acting if one.name == "cordic_truncation"]
    if truncated:
        told = cordic((x, y), int(truncated[0].parameters["iterations"]))
    away = np.radians(told - shaft)
    middle = float(np.angle(np.mean(np.exp(1j * away))))
    return AtRest(shaft, shaft + np.degrees(middle + np.angle(np.exp(1j * (away - middle)))))


def coefficients(error_deg: Array, most: int = 16) -> Array:
    """Complex amplitudes [deg] of orders 1 to ``most`` of an error on an even grid over the turn; shape (most,)."""
    return np.asarray(2.0 * np.fft.rfft(error_deg)[1 : most + 1] / error_deg.size)


def rms_of_orders(error_deg: Array, most: int = 16) -> float:
    """RMS [deg] over orders 1 to ``most``: the mean is nobody's to know."""
    return math.sqrt(float(np.sum(np.abs(coefficients(error_deg, most)) ** 2)) / 2.0)
