"""Every ratio of speeds that the points of a turn can tell: which a reading goes with, and whether it goes round."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.setup.harmonics import FALSE_ALARM
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


def goes_round(same: float, other: float, rows: int) -> bool:
    """Whether a reading that goes with a ratio turns round, and does not swing to and fro along one line.

    ``same`` and ``other`` say how closely it goes with the ratio in its own sense and in the other. What swings is as
    close to both; a field that turns, however flat its ellipse, is closer to one.
    """
    from scipy.stats import norm

    left = max(1.0 - same**2 - other**2, 0.0)
    return same - other > float(norm.isf(FALSE_ALARM)) * float(np.sqrt(left / rows))


@dataclass(frozen=True)
class Closest:
    """The ratio that a reading goes with most closely.

    Attributes
    ----------
    chance : float
        Probability that readings which know nothing of each other go with any ratio as closely.
    highest : float
        The highest ratio that was looked at.
    ratio : float
        The ratio, positive in either sense.
    goes_round : bool
        Whether the reading turns in one sense; else it swings to and fro.
    whole : bool
        Whether the ratio may be a whole number: what is on the shaft comes again with each turn.
    """

    chance: float
    highest: float
    ratio: float = 0.0
    goes_round: bool = False
    whole: bool = True


def closest_ratio(travel_deg: Array, reading_deg: Array) -> Closest:
    """The ratio that a reading (n,) goes with most closely, and whether that is chance.

    Of readings that know nothing of each other the power at any ratio is exponential.
    """
    from scipy.stats import chi2

    part = part_to_search(travel_deg)
    at, turning = travel_deg[part.rows], np.exp(1j * np.radians(reading_deg[part.rows]))
    wave = turning - np.mean(turning)
    power = float(np.mean(np.abs(wave) ** 2))
    if not part.ratios.size or power <= 0.0:
        return Closest(1.0, 0.0)
    close = closeness(at, wave, part.ratios)
    rows = wave.size
    strongest = float(np.max(close)) ** 2 * rows / power
    chance = min(2.0 * part.ratios.size * float(np.exp(-strongest)), 1.0)
    place = int(np.argmax(np.sum(close**2, axis=0)))
    finer = part.ratios[place] + np.linspace(-1.0, 1.0, 41) * part.finest
    both = np.array([closeness(at, wave, np.array([ratio]))[:, 0] for ratio in (*finer, np.round(part.ratios[place]))])
    best = int(np.argmax(np.sum(both**2, axis=1)))
    same, other = np.sort(both[best])[::-1] / np.sqrt(power)
    # Twice the gain in log likelihood of the ratio over the whole one next to it.
    left = max(power - float(np.sum(both[best] ** 2)), 1e-300)
    gain = 2.0 * rows * float(np.sum(both[best] ** 2) - np.sum(both[-1] ** 2)) / left
    return Closest(
        chance,
        float(part.ratios[-1]),
        float(finer[best]) if best < finer.size else float(np.round(part.ratios[place])),
        goes_round(float(same), float(other), rows),
        gain <= float(chi2.isf(FALSE_ALARM, 1)),
    )
