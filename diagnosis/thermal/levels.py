"""Which temperatures readings were taken at, and how high a power of the temperature they support."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.thermal.recording import SMALLEST_SPAN_K, Recording
from twin.angles import TAU, Array, IntArray

HIGHEST_POWER = 2
"""Per kelvin, and per kelvin squared: what data sheets give of a drift. What is left of it counts as scatter."""
_MOST_LEVELS = 8
_WIDEST_GAP_RAD = np.radians(120.0)
"""Readings that leave more of the circle open do not tell the factors of a level."""
_FEWEST_ROWS = 8
_LEFT_OF_A_POWER = 0.2
"""RMS that lower powers must leave of a power over the levels, on a scale from -1 to 1, for it to be fitted."""


@dataclass(frozen=True)
class Span:
    """Lowest and highest temperature [C]; laws are fitted in t from -1 to 1 between them."""

    low_c: float
    high_c: float

    @property
    def middle_c(self) -> float:
        """Where t is 0."""
        return 0.5 * (self.low_c + self.high_c)

    @property
    def half_K(self) -> float:
        """From the middle to either end."""
        return max(0.5 * (self.high_c - self.low_c), 1e-9)

    def powers(self, temperature_c: Array | float, highest: int) -> Array:
        """1, t, t^2, ... (highest + 1, ...) at temperatures (...) [C]."""
        t = (np.asarray(temperature_c, dtype=np.float64) - self.middle_c) / self.half_K
        return np.stack([t**j for j in range(highest + 1)])

    def clipped(self, temperature_c: Array | float) -> Array:
        """Temperatures [C], those beyond the span moved to its end."""
        return np.clip(np.asarray(temperature_c, dtype=np.float64), self.low_c, self.high_c)


@dataclass(frozen=True, eq=False)
class Levels:
    """Temperatures [C] (levels,), ascending, each the mean of readings all round the turn; the level (n,) of each."""

    temperature_c: Array
    of_reading: IntArray

    def __len__(self) -> int:
        return int(self.temperature_c.size)

    def power(self, span: Span) -> int:
        """The highest power of the temperature that the levels part from the lower ones."""
        powers = span.powers(self.temperature_c, min(HIGHEST_POWER, len(self) - 1))
        for j in range(1, powers.shape[0]):
            lower = powers[:j].T
            left = powers[j] - lower @ np.linalg.lstsq(lower, powers[j], rcond=None)[0]
            if np.sqrt(np.mean(left**2)) < _LEFT_OF_A_POWER:
                return j - 1
        return int(powers.shape[0] - 1)


def levels_of(recording: Recording) -> Levels:
    """Readings grouped by temperature, from the coldest on; each group is wide enough to see the turn."""
    order = np.argsort(recording.temperature_c, kind="stable")
    temperature, reference = recording.temperature_c[order], recording.reference_rad[order]
    width = max(SMALLEST_SPAN_K, recording.span_K / _MOST_LEVELS)
    level = np.zeros(len(recording), dtype=np.int64)
    start, number = 0, -1
    while start < order.size:
        end, reach = start, width
        while end < order.size and not _sees_the_turn(reference[start:end]):
            end = int(np.searchsorted(temperature, temperature[start] + reach))
            reach += width
        # What is left at the hot end without a turn of its own belongs to the level before it.
        number += int(number < 0 or _sees_the_turn(reference[start:end]))
        level[order[start:end]] = number
        start = end
    means = np.bincount(level, weights=recording.temperature_c) / np.bincount(level)
    return Levels(means, level)


def widest_gap_rad(reference_rad: Array) -> float:
    """The largest arc of the circle between neighbours of angles (n,) [rad]."""
    angle = np.sort(np.remainder(reference_rad, TAU))
    return float(np.max(np.diff(angle, append=angle[0] + TAU)))


def _sees_the_turn(reference_rad: Array) -> bool:
    return reference_rad.size >= _FEWEST_ROWS and widest_gap_rad(reference_rad) < _WIDEST_GAP_RAD
