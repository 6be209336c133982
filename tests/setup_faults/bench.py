"""A bench as it should be: a shaft, a reference, a sensor with small errors of its own, and what else is recorded.

Nothing here knows the program.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class Bench:
    """A recording before it is written: columns (n,) under the names of a sweep, angles in degrees and not wrapped.

    ``shaft_deg`` is the true angle, ``error_deg`` the sensor's own error, ``noise_deg`` its scatter, ``points`` the
    readings a turn; ``sensor_bits`` is the length of the word, 0 for a reading in fine decimals.
    """

    shaft_deg: Array
    error_deg: Array
    noise_deg: float
    points: int
    sensor_bits: int
    columns: dict[str, Array] = field(default_factory=dict)
    wrapped: bool = True

    @property
    def n(self) -> int:
        return int(self.shaft_deg.size)

    def column(self, name: str) -> Array:
        return self.columns[name]


def draw(
    rng: np.random.Generator, *, moving: bool | None = None, turns: int | None = None, points: int | None = None
) -> Bench:
    """A recording without a fault."""
    points = int(rng.integers(40, 400)) if points is None else points
    turns = int(rng.integers(1, 6)) if turns is None else turns
    moving = bool(rng.random() < 0.5) if moving is None else moving
    both_ways = not moving and bool(rng.random() < 0.4)
    steps = np.arange(points * turns + 1) * (360.0 / points)
    if not moving and rng.random() < 0.5:
        steps = steps + rng.uniform(-0.2, 0.2, steps.size) * (360.0 / points)
    shaft = np.concatenate([steps, steps[::-1]]) if both_ways else steps
    shaft = shaft + rng.uniform(0.0, 360.0)
    bench = Bench(
        shaft,
        _own_error(shaft, rng),
        float(10.0 ** rng.uniform(-2.0, -0.8)),
        points,
        int(rng.choice([0, 12, 14, 16])),
        wrapped=bool(rng.random() < 0.7),
    )
    bench.columns["reference_deg"] = shaft.copy()
    bench.columns["measured_deg"] = shaft + rng.uniform(0.0, 360.0) + bench.error_deg + scatter(bench, rng)
    _clock(bench, moving, rng)
    _beside(bench, rng)
    return bench


def scatter(bench: Bench, rng: np.random.Generator, *, times: float = 1.0) -> Array:
    """The sensor's noise (n,) [deg]."""
    return times * bench.noise_deg * rng.standard_normal(bench.n)


def _own_error(shaft: Array, rng: np.random.Generator) -> Array:
    """What any sensor has: up to 1.5 deg of order 1, and less of orders 2 and 4."""
    error = np.zeros_like(shaft)
    for order, most in ((1, 1.5), (2, 0.8), (4, 0.3)):
        error += rng.uniform(0.0, most) * np.sin(np.radians(order * shaft) + rng.uniform(0.0, 2.0 * np.pi))
    return error


def _clock(bench: Bench, moving: bool, rng: np.random.Generator) -> None:
    if moving:
        # From row to row less than 15 ms: longer ones are taken for stops.
        slowest = 60.0 / 0.015 / bench.points
        rpm = slowest * float(10.0 ** rng.uniform(0.0, 1.0))
        period = 60.0 / rpm / bench.points
        bench.columns["time_s"] = np.arange(bench.n) * period
        if rng.random() < 0.5:
            bench.columns["speed_rpm"] = rpm * (1.0 + 0.001 * rng.standard_normal(bench.n))
    elif rng.random() < 0.5:
        bench.columns["time_s"] = np.cumsum(0.5 + 0.1 * rng.random(bench.n))


def _beside(bench: Bench, rng: np.random.Generator) -> None:
    """Columns that logs hold: channels, field, gain, status, frames, temperature; each in some of them."""
    if rng.random() < 0.35:
        bench.columns |= channels(bench, rng)
    if rng.random() < 0.3:
        swing = 1.0 + 0.02 * np.sin(np.radians(bench.shaft_deg) + rng.uniform(0.0, 6.0))
        bench.columns["magnitude"] = np.round(1800.0 * swing + 3.0 * rng.standard_normal(bench.n))
    if rng.random() < 0.3:
        bench.columns["agc"] = np.round(float(rng.integers(40, 120)) + rng.standard_normal(bench.n))
    if rng.random() < 0.3:
        bench.columns["status"] = np.full(bench.n, float(rng.choice([0.0, 1.0, 32.0])))
    if rng.random() < 0.3:
        # A nibble, the 0 to 14 of AUTOSAR's end-to-end protection, a byte, decimal digits, a stamp in steps of 10.
        step, modulus = rng.choice([[1, 16], [1, 15], [1, 256], [1, 100], [10, 1000], [3, 256], [1, 65536]])
        bench.columns["frame"] = np.mod(step * (np.arange(bench.n) + float(rng.integers(0, 200))), float(modulus))
    if rng.random() < 0.3:
        bench.columns["temperature_c"] = 24.0 + 0.01 * np.cumsum(rng.standard_normal(bench.n))


def channels(
    bench: Bench, rng: np.random.Generator, *, offset: float = 0.02, limit: float = np.inf
) -> dict[str, Array]:
    """The two channels [codes] whose angle is the reading, about zero, with an offset of up to this share."""
    size = float(10.0 ** rng.uniform(2.5, 4.0))
    at = np.radians(bench.columns["measured_deg"])
    each = []
    for wave in (np.cos(at), np.sin(at)):
        one = size * (wave + rng.uniform(-offset, offset)) + 1e-3 * size * rng.standard_normal(bench.n)
        each.append(np.round(np.clip(one, -limit * size, limit * size)))
    return {"vx": each[0], "vy": each[1]}
