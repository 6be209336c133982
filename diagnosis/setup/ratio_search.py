"""Every ratio of speeds that the points of a turn can tell: which one a reading goes with, and whether by chance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import Array, IntArray

_MOST_RATIO = 4096.0
"""Periods a turn: finer scales are read by optics, not by magnets."""
_TURNS, _ROWS = 3.0, 1500
_SHARE_OF_WIDTH = 0.2
"""A line is one ratio wide for each turn that was travelled; this is the share of it that ratios lie apart."""
_AT_ONCE = 64


@dataclass(frozen=True, eq=False)
class Searched:
    """A part of a record in which ratios are searched.

    Attributes
    ----------
    rows : ndarray
        Places (m,) of the rows used.
    ratios : ndarray
        The ratios (k,), positive and ascending, up to half the points a turn.
    turns : float
        Turns that the part goes through.
    """

    rows: IntArray
    ratios: Array
    turns: float

    @property
    def finest(self) -> float:
        """How far apart the ratios lie."""
        return _SHARE_OF_WIDTH / self.turns


def part_to_search(travel_deg: Array) -> Searched:
    """The rows and the ratios of a reference (n,) [deg] over its turns."""
    inside = np.flatnonzero(np.abs(travel_deg - travel_deg[0]) <= 360.0 * _TURNS)
    inside = inside[: int(np.argmax(np.diff(inside, append=inside[-1] + 2) > 1)) + 1]
    steps = np.abs(np.diff(travel_deg[inside]))
    steps = steps[steps > 0.0]
    turns = max(float(np.ptp(travel_deg[inside])) / 360.0, 0.1)
    # A reference that trembles where it stands has tiny steps: no more ratios than as many rows can tell.
    by_steps = 180.0 / float(np.median(steps)) if steps.size else 0.0
    most = min(by_steps, 0.5 * inside.size / turns, _MOST_RATIO)
    if inside.size > _ROWS:
        # Every k-th row would make a high ratio look like a low one; rows at random do not. The seed is that of a draw
        # without meaning: the same rows each time.
        inside = np.sort(np.random.default_rng(0).choice(inside, _ROWS, replace=False))
    step = _SHARE_OF_WIDTH / turns
    return Searched(inside, np.arange(step, most, step), turns)


def closeness(at_deg: Array, wave: Array, ratios: Array) -> Array:
    """How closely a complex wave (m,) goes with each of even ratios (k,) of an angle (m,) [deg]: |mean|, (2, k).

    The first row is that of the same sense, the second that of the other.
    """
    both = np.stack([wave, np.conj(wave)])
    at = np.radians(at_deg)
    block = np.exp(-1j * np.outer(at, ratios[:_AT_ONCE] - ratios[0]))
    parts = [
        np.abs(both * np.exp(-1j * ratios[first] * at) @ block[:, : ratios[first : first + _AT_ONCE].size])
        for first in range(0, ratios.size, _AT_ONCE)
    ]
    return np.asarray(np.concatenate(parts, axis=1) / at.size)


def p_of_any_ratio(travel_deg: Array, reading_deg: Array) -> tuple[float, float]:
    """Probability that chance makes a reading (n,) go with some ratio as closely as it does, and the highest ratio.

    Of readings that know nothing of each other the power at any ratio is exponential.
    """
    part = part_to_search(travel_deg)
    turning = np.exp(1j * np.radians(reading_deg[part.rows]))
    wave = turning - np.mean(turning)
    power = float(np.mean(np.abs(wave) ** 2))
    if not part.ratios.size or power <= 0.0:
        return 1.0, 0.0
    close = closeness(travel_deg[part.rows], wave, part.ratios)
    strongest = float(np.max(close)) ** 2 * wave.size / power
    return min(2.0 * part.ratios.size * float(np.exp(-strongest)), 1.0), float(part.ratios[-1])
