"""Tables for drives against the best table of their size, on readings that neither has seen.

``python -m tests.benchmarks.drive_tables --draws 50 --seed 1``. Each draw is a sensor by a formula of its own: offsets,
unequal gains, phase, a cubic saturation and two lines of the magnet, counting either way, with white noise. One sweep
of two turns makes each table, as ``halltwin export`` does. The best of its size is found on the noise-free curve
without the program's own fitting (a linear programme, an integer one where the words are coarse, and where the points
are free, lines that need not even meet). Both are judged on a fresh sweep of four turns, with noise, between the angles
of the first.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from diagnosis.correction.calibration import calibrate
from diagnosis.correction.compensation import correction_of
from diagnosis.correction.targets.known import target_of
from diagnosis.correction.wanted import Wanted
from tests.diagnosis.correction.best_table import (
    even_weights,
    smallest_worst,
    smallest_worst_of_free_pieces,
    smallest_worst_of_whole_numbers,
)
from twin.angles import TAU, Array, wrap

ASKED = (
    *("simplefoc:200", "simplefoc:32", "moteus", "moteus:32", "klipper", "mechaduino", "magalpha", "c:64", "c:16"),
    *("autosar:32", "lut:64", "lut:12"),
)
_NODES = {"klipper": 64}
"""Entries that the drive itself makes of those that are written."""
_GRID = 1024
_STEP_DEG = 360.0 / 4096


@dataclass(frozen=True, eq=False)
class Device:
    """A sensor: factors of its channels, two lines of its magnet, its sense and zero, and its noise [rad]."""

    factors: Array
    lines: Array
    sense: int
    zero_rad: float
    noise_rad: float

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Device:
        """Errors of a degree or so; noise from 0.01 to 0.05 deg."""
        factors = rng.normal(0.0, [0.01, 0.01, 0.015, 0.01, 0.004])
        lines = np.array([[rng.integers(3, 12), np.radians(rng.uniform(0.01, 0.1)), rng.uniform(0, TAU)] for _ in "ab"])
        noise = np.radians(rng.uniform(0.01, 0.05))
        return cls(factors, lines, int(rng.choice([-1, 1])), float(rng.uniform(-np.pi, np.pi)), float(noise))

    def readings(self, shaft: Array) -> Array:
        """Noise-free readings [rad] at shaft angles (n,) [rad]."""
        at = self.sense * shaft + self.zero_rad
        x, y = np.cos(at) + self.factors[0], (1.0 + self.factors[2]) * np.sin(at + self.factors[3]) + self.factors[1]
        lines = sum(size * np.sin(order * shaft + phase) for order, size, phase in self.lines)
        return np.asarray(np.arctan2(y - self.factors[4] * y**3, x - self.factors[4] * x**3) + lines)

    def sweep(self, turns: int, first: float, rng: np.random.Generator) -> tuple[Array, Array]:
        """Reference and readings [rad] of 180 angles a turn, the first so many steps from zero."""
        reference = TAU * (np.arange(180 * turns) + first) / 180
        return reference, self.readings(reference) + self.noise_rad * rng.standard_normal(reference.size)

    def away(self) -> Callable[[Array], Array]:
        """What is to be added to slope x reading [deg] for the shaft angle, at readings of any shape."""
        shaft = TAU * np.arange(-200, 65736) / 65536
        reading = np.unwrap(self.readings(shaft))
        wanted = np.unwrap(wrap(shaft - self.sense * reading))
        order = np.argsort(reading)
        start = float(reading[order][0])
        return lambda at: np.degrees(
            wrap(np.interp(start + np.mod(at - start, TAU), reading[order], wanted[order]) - wanted.mean())
            + wrap(wanted.mean())
        )


def best_of(asked: str, away: Callable[[Array], Array], reading: Array) -> Array:
    """What the best table of this kind and size adds to slope x reading [deg] at readings (n,)."""
    target, entries = target_of(asked)
    if target.name == "mechaduino":
        return away(reading)
    if target.name == "autosar":
        ends = np.linspace(-np.pi, np.pi, 2 * _GRID + 1)
        curve = np.degrees(np.unwrap(np.radians(away(ends))))
        return np.interp(wrap(reading), ends, smallest_worst_of_free_pieces(curve, entries - 1)[1])
    count, first = _NODES.get(target.name, entries), 0.5 if asked == "moteus:32" else 0.0
    grid = TAU * (np.arange(_GRID) + 0.25) / _GRID
    wanted = np.degrees(np.unwrap(np.radians(away(grid))))
    middle = float(wanted.mean())
    weights = even_weights(grid, count, first)
    if target.name == "magalpha":
        _, found = smallest_worst_of_whole_numbers(weights * _STEP_DEG, wanted - middle, seconds=5.0)
        found = found * _STEP_DEG
    else:
        _, found = smallest_worst(weights, wanted - middle)
    return even_weights(reading, count, first) @ found + middle


def ratios(asked: str, device: Device, seed: int) -> Array:
    """RMS and largest error of the exported table over those of the best, on a fresh sweep."""
    rng = np.random.default_rng(seed)
    reference, reading = device.sweep(2, 0.0, rng)
    calibration = calibrate(reference, reading, rng=np.random.default_rng(0))
    wanted = Wanted.of(correction_of(calibration.chain, tolerance_deg=1e-4))
    target, entries = target_of(asked)
    table = target.stored(wanted, entries, "worst")
    fresh, seen = device.sweep(4, 0.37, rng)
    if target.name == "mechaduino":
        # Its encoder counts, which the best table cannot help.
        seen = np.round(seen / TAU * entries) * TAU / entries
    ours = np.degrees(wrap(target.shaft(table, wanted, seen) - fresh))
    added = best_of(asked, device.away(), seen)
    best = np.degrees(wrap(device.sense * seen + np.radians(added) - fresh))
    return np.array([np.sqrt(np.mean(ours**2) / np.mean(best**2)), np.max(np.abs(ours)) / np.max(np.abs(best))])


def main() -> None:
    """Print for each kind of table how its error compares with that of the best."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    print("held-out error over that of the best table   RMS: mean  largest   at the worst: mean  largest   within 10 %")
    for asked in ASKED:
        found = []
        for draw in range(given.draws):
            device = Device.drawn(np.random.default_rng([given.seed, draw]))
            found.append(ratios(asked, device, given.seed + 1000 * draw))
        ratio = np.array(found)
        within = int(np.count_nonzero(ratio[:, 0] <= 1.1))
        means, most = ratio.mean(axis=0), ratio.max(axis=0)
        print(
            f"{asked:44s} {means[0]:10.3f} {most[0]:8.3f} {means[1]:20.3f} {most[1]:8.3f}   {within} of {given.draws}"
        )


if __name__ == "__main__":
    main()
