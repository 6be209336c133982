"""Whole counts: a reference that reads in steps, and where between two of them an even motion had the shaft.

Counts of a shaft that goes on evenly from row to row are those of a digital straight line: there is a line from which
none is off by more than half a count (the condition is exact: A. Rosenfeld, "Digital straight line segments", IEEE
Transactions on Computers C-23, 1974). The longer the stretch over which one line will do, the closer it is known.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from twin.angles import TAU, Array, IntArray, within_turn, wrap
from twin.runs import runs

_ROWS = 8
"""Rows of the shortest stretch: a line has two parameters, and fewer rows hardly say that they lie on one."""
_MOST_COUNTS = 1_000_000
"""The step of 0.0004 deg is beyond what any bench would call rounding."""
_OFF = 0.05
"""RMS distance, in counts, that is none: it is that of a file's decimals. Rounding makes 0.29."""
_SAME_RAD = 1e-8
"""Angles that differ by less are one."""
_MOST_TRIED = 5000
"""Numbers of counts: more are as good as any."""
_TRIED_WINDOWS = 1000
"""Short stretches by which the way is judged: a share of them is known to 0.03."""
_FEW = 100
"""Readings by which the number of counts is chosen, all of which must then agree."""
_LONG = 8 * _ROWS
"""Rows of a stretch whose own counts tell as much as those of the whole record."""
_HALVINGS = 50
"""Of the range of a line's slopes, to the precision of a double."""
_ROUNDING = 1e-9
_PLACES = 6
"""Decimals to which counts of a part of a turn are known."""
_WHOLE = 1e-5
"""Distance from a whole number of decimals that is the rounding of a double."""


@dataclass(frozen=True, eq=False)
class WholeCounts:
    """A reference that reads whole counts while the shaft goes on evenly.

    Attributes
    ----------
    counts_per_turn : float
        Counts of a turn; no whole number where a turn has none, as in a file of few decimals of a radian.
    counts : ndarray
        What it has counted since its first reading, (n,); where a turn has no whole number, not whole from turn to turn
        either.
    by_stops : bool
        Whether it is from stop to stop that the shaft goes on evenly, with several readings at each.
    """

    counts_per_turn: float
    counts: Array
    by_stops: bool

    @cached_property
    def off(self) -> Array:
        """Each reading less where the shaft stood, (n,), in counts; 0 where that is not known."""
        if not self.by_stops:
            return _off(self.counts)
        stops = _stops(self.counts)
        return np.asarray(_off(self.counts[stops])[np.cumsum(stops) - 1])

    def averaged(self, group: IntArray) -> WholeCounts:
        """The same of means over groups of readings, (n,) numbers from 0 in their order; one stop is one group."""
        many = np.bincount(group)
        found = replace(self, counts=np.bincount(group, self.counts) / many, by_stops=False)
        found.__dict__["off"] = np.bincount(group, self.off) / many
        return found

    def part(self, rows: IntArray) -> WholeCounts:
        """The same at these rows (m,): from all readings, unless the rows themselves lie in long stretches."""
        found = replace(self, counts=self.counts[rows])
        stretches = 1 + np.count_nonzero(np.diff(rows) != 1)
        if rows.size < _LONG * stretches:
            found.__dict__["off"] = self.off[rows]
        return found


def whole_counts(shaft_rad: Array) -> WholeCounts | None:
    """What a reference's readings (n,) [rad], in the order of the rows, tell of their rounding.

    Parameters
    ----------
    shaft_rad : ndarray
        The reference's readings [rad], (n,), unwrapped, each of them finite.

    Returns
    -------
    WholeCounts or None
        None where they lie on no grid, neither of a whole number of counts a turn nor of few decimals of a radian,
        where the shaft did not go on evenly (then nothing tells where between two counts it stood), and where each
        stood at a count.
    """
    for counts_per_turn, counts in _grids(shaft_rad):
        # Several readings at one stop are of one angle; a shaft that moves evenly may also stay within a count.
        for by_stops, moving in ((False, counts), (True, counts[_stops(counts)])):
            if _mostly_straight(moving):
                found = WholeCounts(counts_per_turn, counts, by_stops)
                if float(np.sqrt(np.mean(found.off**2))) > _OFF:
                    return found
    return None


def _grids(shaft_rad: Array) -> Iterator[tuple[float, Array]]:
    """Grids on which readings (n,) [rad] lie: counts of a turn, and what was counted since the first reading, (n,)."""
    if shaft_rad.size < _ROWS:
        return
    turned = shaft_rad - shaft_rad[0]
    for decimal in dict.fromkeys(
        _last_decimal(values) for values in (shaft_rad, within_turn(shaft_rad), wrap(shaft_rad))
    ):
        if decimal is not None and decimal * _MOST_COUNTS > TAU:
            # A turn is no whole number of these. Equal readings stay equal: the rest is the rounding of a double.
            yield TAU / decimal, np.round(turned / decimal, _PLACES)
    for counts_per_turn in counts_of_a_turn(shaft_rad):
        yield counts_per_turn, np.round(turned / TAU * counts_per_turn)


def _mostly_straight(counts: Array) -> bool:
    """Whether most short stretches of counts (n,) are those of a line, and not all of one and the same step."""
    way = _way(counts)
    if not np.any(np.abs(np.diff(counts, 2)[way[2:] == way[:-2]]) > _ROUNDING):
        # Each stop is at a count.
        return False
    tried = list(_short(counts, way))
    return 2 * sum(_straight(some) for some in tried) > len(tried)


def _stops(counts: Array) -> npt.NDArray[np.bool_]:
    """Which readings (n,) are the first at their count."""
    return np.concatenate([[True], np.diff(counts) != 0.0])


def _short(counts: Array, way: IntArray) -> Iterator[Array]:
    """Short stretches of counts (n,) of one direction, spread evenly over all."""
    if counts.size >= _ROWS:
        for first in np.unique(np.linspace(0, counts.size - _ROWS, _TRIED_WINDOWS).astype(np.int64)):
            if way[first] == way[first + _ROWS - 1]:
                yield counts[first : first + _ROWS]


def _way(counts: Array) -> IntArray:
    """Number (n,) of the stretch of one direction that each reading is of; a stop where it turns round is its own."""
    step = np.sign(np.diff(counts))
    moved = np.flatnonzero(step)
    if not moved.size:
        return np.zeros(counts.size, dtype=np.int64)
    rows = np.arange(step.size)
    before = step[moved[np.clip(np.searchsorted(moved, rows, "right") - 1, 0, None)]]
    after = step[moved[np.clip(np.searchsorted(moved, rows), None, moved.size - 1)]]
    way = before + after
    return np.concatenate([[0], np.cumsum(np.concatenate([[0], np.diff(way) != 0.0]))]).astype(np.int64)


def counts_of_a_turn(shaft_rad: Array) -> Iterator[int]:
    """On how many even steps of the turn readings (n,) [rad] lie, all of them, from whichever zero: the fewest first.

    The step is the least by which two steps from row to row differ, or a half, a third or a quarter of it. Steps that
    differ by the last decimal of the file are the same, unless it is that decimal to which the reference was rounded.
    """
    if shaft_rad.size < _ROWS:
        return
    sizes = np.unique(np.round(np.abs(wrap(np.diff(shaft_rad))) / _SAME_RAD)) * _SAME_RAD
    told: set[int] = set()
    for same in (*_last_decimals_rad(shaft_rad), 0.5 * TAU / _MOST_COUNTS):
        found = _counts_by(shaft_rad, sizes, same)
        if found is not None and found not in told:
            told.add(found)
            yield found


def _last_decimals_rad(shaft_rad: Array) -> list[float]:
    """By how much [rad] two steps that are the same differ in a file of few decimals, in degrees or in radians."""
    told = (
        (unit, _last_decimal(values))
        for unit, values in ((TAU / 360.0, np.degrees(shaft_rad)), (1.0, shaft_rad), (1.0, within_turn(shaft_rad)))
    )
    # Each of two angles is off by half a decimal at the most, and so is each of two others.
    return [2.0 * unit * decimal for unit, decimal in told if decimal is not None]


def _last_decimal(values: Array) -> float | None:
    """The place of the last decimal that numbers (n,) have, of one to five; None where there are more."""
    for decimals in (1, 2, 3, 4, 5):
        places = values * 10.0**decimals
        if np.max(np.abs(places - np.round(places))) < _WHOLE:
            return float(10.0**-decimals)
    return None


def _counts_by(shaft_rad: Array, sizes: Array, same: float) -> int | None:
    """The counts of a turn by the least difference of the steps' sizes (m,) [rad], which up to ``same`` is none."""
    differences = np.diff(np.concatenate([[0.0], sizes]))
    differences = differences[differences > same * (1.0 + _OFF)]
    if not differences.size:
        return None
    least = float(np.min(differences))
    few = shaft_rad[np.unique(np.linspace(0, shaft_rad.size - 1, _FEW).astype(np.int64))]
    for share in (1, 2, 3, 4):
        about = share * TAU / least
        # Decimals of the file leave the step uncertain, and with it how many make a turn.
        off = about * (0.5 * _OFF + same / least)
        near = np.arange(max(2, int(about - off)), min(_MOST_COUNTS, int(about + off) + 1) + 1)
        if 0 < near.size <= _MOST_TRIED:
            best = int(near[np.argmax(_resultant(few, near[:, None]))])
            # Rounding to the last decimal spreads the readings evenly over so much of a count; whole, it hides them.
            decimal = 0.5 * same * best / TAU
            spread = np.sinc(decimal) * np.exp(-0.5 * (TAU * _OFF) ** 2)
            if decimal < 1.0 and float(_resultant(shaft_rad, best)) > spread:
                return best
    return None


def _resultant(angle_rad: Array, counts: int | IntArray) -> Array:
    """Mean resultant length of an angle (n,) within a count: 1 where all lie at one place of it."""
    return np.asarray(np.abs(np.mean(np.exp(1j * (counts * angle_rad)), axis=-1)))


def _off(counts: Array) -> Array:
    """Each count (n,) less the way that it lies on, over stretches that are each as long as one line will do.

    Each begins in the middle of the one before, and a reading counts in both by how far it lies from their ends: there
    a way that is bent leaves its line the most.
    """
    total, weight = np.zeros(counts.size), np.zeros(counts.size)
    for rows in runs(_way(counts)):
        for first, many in _stretches(counts[rows]):
            part = slice(rows.start + first, rows.start + first + many)
            from_ends = 1.0 - np.abs(np.linspace(-1.0, 1.0, many + 2)[1:-1])
            total[part] += from_ends * _off_parabola(counts[part])
            weight[part] += from_ends
    return np.divide(total, weight, out=total, where=weight > 0.0)


def _stretches(counts: Array) -> Iterator[tuple[int, int]]:
    """First row and length of each stretch that lies on a line, the last of them found from the end."""
    first = 0
    while first + _ROWS <= counts.size:
        many = _rows_on_a_line(counts[first:])
        if many:
            yield first, many
        if first + many == counts.size:
            return
        first += max(many // 2, 1)
    many = _rows_on_a_line(counts[::-1])
    if many:
        yield counts.size - many, many


def _off_line(counts: Array) -> Array:
    """Each count (n,) less the line of least squares, which a row that is of the next stretch hardly moves."""
    rows = np.arange(counts.size) - 0.5 * (counts.size - 1)
    return np.asarray(counts - np.mean(counts) - rows * (rows @ counts) / (rows @ rows))


def _off_parabola(counts: Array) -> Array:
    """The same of the parabola: what lines leave of a way that speeds up would follow its acceleration."""
    rows = np.linspace(-1.0, 1.0, counts.size)
    bent = rows**2 - np.mean(rows**2)
    left = _off_line(counts)
    return np.asarray(left - bent * (bent @ left) / (bent @ bent))


def _rows_on_a_line(counts: Array) -> int:
    """How many rows from the first lie on one line; 0: not as many as a stretch has."""
    if counts.size < _ROWS or not _straight(counts[:_ROWS]):
        return 0
    good, step = _ROWS, _ROWS
    while good + step <= counts.size and _straight(counts[: good + step]):
        good, step = good + step, 2 * step
    bad = min(counts.size + 1, good + step)
    while bad - good > 1:
        middle = (good + bad) // 2
        good, bad = (middle, bad) if _straight(counts[:middle]) else (good, middle)
    return good


def _straight(counts: Array) -> bool:
    """Whether counts (n,) are those of a straight line: some line is within half a count of each.

    The width of the band that holds them is a convex function of its slope, and is least where its own slope changes
    sign.
    """
    rows = np.arange(counts.size, dtype=np.float64)
    # Its ends are off by half a count each at the most, which bounds the slope.
    middle, around = (counts[-1] - counts[0]) / rows[-1], 1.0 / rows[-1]
    low, high = middle - around, middle + around
    for _ in range(_HALVINGS):
        left = counts - 0.5 * (low + high) * rows
        top, bottom = int(np.argmax(left)), int(np.argmin(left))
        width, falls = left[top] - left[bottom], rows[top] - rows[bottom]
        if width <= 1.0:
            return True
        # From here the band narrows by `falls` for each unit of slope, at best to the end of the range.
        if width - abs(falls) * 0.5 * (high - low) > 1.0:
            return False
        low, high = (0.5 * (low + high), high) if falls > 0.0 else (low, 0.5 * (low + high))
    return bool(width <= 1.0 + _ROUNDING)
