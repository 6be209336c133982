"""In which unit two angles of a log are, told by their values: the units in which one follows the other."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from twin.angles import Array, wrap_deg
from twin.following import distance_deg, follows, spread_deg
from twin.logs.names import Meaning
from twin.logs.restarts import restarts
from twin.logs.statement import Column, Term
from twin.logs.units import UNITS
from twin.reading_grid import even_step_deg

_ROUND = (100, 120, 125, 144, 150, 160, 180, 200, 240, 250, 300, 360, 400, 500, 600, 720, 800, 900)
COUNTS_PER_TURN = tuple(
    sorted(
        {2**k for k in range(6, 25)}
        | {200 * 2**k for k in range(12)}
        | {m * 10**k for m in _ROUND for k in range(5)}
        | {1_296_000}
    )
)
"""Counts of a turn that encoders, converters and steppers have: powers of two, whole steps, and round numbers."""
_JUDGED_ROWS = 2000
_CLEARLY, _CLEARLY_ON_A_PART, _ALIKE_DEG = 2.0, 5.0, 0.02
"""One unit is clearly meant where another's error, of a span of 360, is so many times as large and this much more; on a
part of a turn an error of order 1 makes up for a wrong number of counts, or for most of it."""
_FEW = 4
"""Numbers of counts a turn up to which a column is taken to show its own."""
_MOST_GUESSED_DEG = 15.0
"""A sensor may be farther off than this, but no unit is guessed by it."""
_PARTED_TURNS = 0.9
"""Turns from which what repeats with them is told from what grows."""
_DRIFT, _LEAST_DRIFT_DEG = 6.0, 0.1
"""A wrong number of counts drifts, in a turn by more than so many times what scatters about it, and this much more."""
_DRIFT_ON_A_PART, _LEAST_ON_A_PART_DEG = 10.0, 4.0
"""The same on a part of a turn, where errors of orders 1 and 2 seem to drift, too."""
_SMALL_STEP_DEG = 90.0
"""Rows that are typically closer than this follow one another round the turn."""
_DEGREES_OF_TURNS = 400.0
"""Whole numbers from 0 on that go beyond it are no degrees of one turn."""
_FULL_SHARE = 0.9
"""Share of a turn that wrapped counts fill at least."""
_DIGITS, _WHOLE = 6, 1e-9
"""Digits behind the point of which the last is looked for, and how far from it what a file holds may lie."""
_EVEN = 0.8
"""By how much an angle moves at least with the other, on a span that tells little of units."""
_LEAST_DEG, _SHORT_DEG = 6.4, 100.0
"""A span up to the first looks like one turn of radians, or less; one up to the second may be several."""


@dataclass(frozen=True)
class AngleUnit:
    """A unit of an angle: a name that ``--columns`` knows, or counts by how many make a turn."""

    name: str = ""
    counts: int = 0

    def degrees(self, values: Array) -> Array:
        """Values (n,) in degrees."""
        return UNITS[self.name].converted(values) if self.name else values * 360.0 / self.counts

    def column(self, target: str, source: str) -> Column:
        """The statement of a column in this unit."""
        if self.counts:
            return Column(target, Term(source, (("*", 360.0), ("/", float(self.counts)))))
        return Column(target, Term(source), None if self.name == "deg" else self.name)

    def __str__(self) -> str:
        return f"{self.counts} counts a turn" if self.counts else self.name


TURN = {name: 360.0 / UNITS[name].factor for name in ("deg", "rad", "rev", "gon")}
"""By unit what a turn is, of those in which an angle begins anew after one."""
Pair = tuple[AngleUnit, AngleUnit]
_BOTH_DEG, _BOTH_RAD = (AngleUnit("deg"), AngleUnit("deg")), (AngleUnit("rad"), AngleUnit("rad"))


def units_of_pair(reference: Array, measured: Array, *, said: tuple[Meaning, Meaning]) -> list[Pair]:
    """The units in which two angles (n,) follow each other, those that fit equally well; none where they do not."""
    both = np.isfinite(reference) & np.isfinite(measured)
    if both.sum() < 4:
        return []
    reference, measured = reference[both], measured[both]
    options = [options_of(values, one) for values, one in zip((reference, measured), said, strict=True)]
    degrees = AngleUnit("deg")
    for own, one, other in zip(options, said, said[::-1], strict=True):
        if one.unit is None and other.unit == UNITS["deg"] and degrees not in own:
            # A short span looks like radians, but beside degrees.
            own.append(degrees)
    many = min(sum(bool(one.counts) for one in each) for each in options) > _FEW
    untold = any(one.unit is None for one in said)
    step = -(-reference.size // _JUDGED_ROWS)
    fitting: list[tuple[float, Pair]] = []
    whole = False
    for pair in itertools.product(options[0], options[1]):
        if many and pair[0].counts and pair[1].counts:
            continue
        a, b = pair[0].degrees(reference[::step]), pair[1].degrees(measured[::step])
        if not _fit(a, b, pair, untold=all(one.unit is None for one in said)) or (
            untold and (distance_deg(b, a) > _MOST_GUESSED_DEG or _lags(a, b))
        ):
            continue
        # By the span, so that no unit wins by making all angles small.
        fitting.append((360.0 * distance_deg(b, a) / float(np.ptp(a)), pair))
        whole = whole or bool(np.ptp(_unwrapped(a)) >= 360.0 * _PARTED_TURNS)
    least = min((distance for distance, _ in fitting), default=0.0)
    times = _CLEARLY if whole else _CLEARLY_ON_A_PART
    kept = [pair for distance, pair in fitting if distance <= times * least + _ALIKE_DEG]
    return _with_rivals(preferred(kept), kept, reference, measured, said=said)


def _fit(reference: Array, measured: Array, pair: Pair, *, untold: bool) -> bool:
    """Whether angles (n,), in degrees by the units of a pair, go round together; ``untold``: no name tells a unit."""
    if min(np.ptp(reference), np.ptp(measured)) == 0.0 or not follows(measured, reference):
        return False
    if untold and {one.name for one in pair} == {"deg"} and max(np.ptp(reference), np.ptp(measured)) <= _LEAST_DEG:
        return False
    return not (any(one.counts for one in pair) and drifts(reference, measured))


def _lags(reference: Array, measured: Array) -> bool:
    """Whether, over a short span, one angle (n,) [deg] moves much less than the other: they may be geared radians."""
    if np.ptp(reference) > _SHORT_DEG:
        return False
    slope = abs(float(np.polyfit(reference - np.mean(reference), measured, 1)[0]))
    return not _EVEN <= slope <= 1.0 / _EVEN


def _with_rivals(
    kept: list[Pair], fitting: list[Pair], reference: Array, measured: Array, *, said: tuple[Meaning, Meaning]
) -> list[Pair]:
    """Where both columns (n,) are degrees for want of a better word, also what else they may be."""
    if kept == [_BOTH_RAD] and all(one.unit is None for one in said):
        # A few degrees of a turn look like most of one in radians.
        whole = max(float(np.ptp(reference)), float(np.ptp(measured))) >= _PARTED_TURNS * TURN["rad"]
        return kept if whole else [_BOTH_RAD, _BOTH_DEG]
    if kept != [_BOTH_DEG]:
        return kept
    span = max(float(np.ptp(reference)), float(np.ptp(measured)))
    if _BOTH_RAD in fitting and span < _SHORT_DEG:
        return [_BOTH_DEG, _BOTH_RAD]
    if all(_may_be_counts(values, one) for values, one in zip((reference, measured), said, strict=True)):
        counts = AngleUnit(counts=2 ** int(np.ceil(np.log2(span + 1.0))))
        return [_BOTH_DEG, (counts, counts)]
    return kept


def _may_be_counts(values: Array, said: Meaning) -> bool:
    """Whether values (n,) without a unit are whole numbers that show no turn of 360: counts or degrees."""
    if said.unit is not None or np.any(values % 1.0 != 0.0):
        return False
    return not bool(np.any(restarts(values)))


def same_angle(measured_deg: Array, reference_deg: Array) -> bool:
    """Whether an angle (n,) follows another closely enough for a unit or a ratio to be guessed by it."""
    return follows(measured_deg, reference_deg) and distance_deg(measured_deg, reference_deg) <= _MOST_GUESSED_DEG


def is_copy(reference: Array, measured: Array, units: Pair) -> bool:
    """Whether two angles (n,) are one, in other units or over other turns: they differ by the rounding of both."""
    rounding, (a, b) = _as_compared(reference, measured, units)
    return bool(np.max(np.abs(wrap_deg(b - a)), initial=0.0) <= rounding)


def is_one_sensors(reference: Array, measured: Array, units: Pair) -> bool:
    """Whether two angles (n,) are those of one sensor: one, or so but for their zero and the way that they count."""
    rounding, (a, b) = _as_compared(reference, measured, units)
    away = (wrap_deg(error - error[:1]) for error in (b - a, b + a))
    return any(one.size == 0 or float(np.ptp(one)) <= 2.0 * rounding for one in away)


def _as_compared(reference: Array, measured: Array, units: Pair) -> tuple[float, tuple[Array, Array]]:
    """What is rounded off two angles [deg], and they [deg] where both are known."""
    both = np.isfinite(reference) & np.isfinite(measured)
    a, b = reference[both], measured[both]
    rounding = rounding_deg(a, units[0]) + rounding_deg(b, units[1])
    return rounding, (units[0].degrees(a), units[1].degrees(b))


def rounding_deg(values: Array, unit: AngleUnit) -> float:
    """By how much [deg] values (n,) in a unit are rounded: half a count, or half of the digit that most of them end in.

    Of numbers with so many digits in all, the large ones have fewer behind the point. Nothing is rounded off angles
    that go on by one and the same step, as those do that were set.
    """
    if even_step_deg(unit.degrees(values)) is not None:
        return 0.0
    if unit.counts:
        return 0.5 * 360.0 / unit.counts
    needs = [np.abs(values - np.round(values, k)) > _WHOLE for k in range(_DIGITS)]
    digits = float(np.median(np.sum(needs, axis=0)))
    return float(0.5 * 10.0**-digits * UNITS[unit.name].factor)


def drifts(reference: Array, measured: Array) -> bool:
    """Whether one angle (n,) [deg] runs away from the other, as with a wrong number of counts a turn."""
    reference = _unwrapped(reference)
    order = np.argsort(reference)
    sense = min((1.0, -1.0), key=lambda one: spread_deg(measured - one * reference))
    error = np.unwrap((measured - sense * reference)[order], period=360.0)
    at = np.radians(reference[order])
    shapes = [np.ones_like(at), at / (2.0 * np.pi)]
    whole = bool(np.ptp(at) >= _PARTED_TURNS * 2.0 * np.pi)
    shapes += [wave(order * at) for order in (1.0, 2.0) for wave in (np.cos, np.sin)] if whole else []
    design = np.stack(shapes, axis=1)
    fitted = np.linalg.lstsq(design, error, rcond=None)[0]
    scatter = float(np.std(error - design @ fitted))
    drift = abs(float(fitted[1])) * (1.0 if whole else float(np.ptp(at)) / (2.0 * np.pi))
    times, least_deg = (_DRIFT, _LEAST_DRIFT_DEG) if whole else (_DRIFT_ON_A_PART, _LEAST_ON_A_PART_DEG)
    return drift > times * scatter + least_deg


def _unwrapped(angle_deg: Array) -> Array:
    """An angle (n,) [deg] over its turns, where its rows follow one another."""
    follow = np.median(np.abs(wrap_deg(np.diff(angle_deg)))) < _SMALL_STEP_DEG
    return np.unwrap(angle_deg, period=360.0) if follow else angle_deg


def options_of(values: Array, said: Meaning) -> list[AngleUnit]:
    """The units that a column (n,) may be in, by its name or else by its values."""
    if said.unit is not None:
        return [AngleUnit(said.unit.name)]
    if said.turns:
        return [AngleUnit(counts=n) for n in said.turns]
    if _of_chip(values, said.of_chip):
        return [AngleUnit(counts=said.of_chip)]
    # "raw" says counts, and stands over parts of a turn too.
    called_counts = said.counts and not bool(np.any(values % 1.0 != 0.0))
    counts = _counts(values, stated=called_counts)
    if called_counts:
        return counts
    span = float(np.ptp(values))
    if bool(np.any(restarts(values))):
        named = [AngleUnit(name) for name, turn in TURN.items() if 0.9 * turn <= span <= 1.001 * turn]
        return named or counts
    named = [AngleUnit("deg")] if span > _LEAST_DEG else []
    named += [AngleUnit("rad"), AngleUnit("rev")] if np.any(values % 1.0 != 0.0) else []
    return named + counts


def _of_chip(values: Array, a_turn: int) -> bool:
    """Whether values (n,) may be words of a part: whole numbers beyond degrees of a turn that fit in its register."""
    whole = bool(np.all(values == np.round(values)))
    return whole and float(np.min(values)) >= 0.0 and _DEGREES_OF_TURNS < float(np.max(values)) < a_turn


def _counts(values: Array, *, stated: bool) -> list[AngleUnit]:
    """Whole numbers as counts: of the numbers that may make a turn those that the values nearly fill, if any."""
    span = float(np.ptp(values))
    whole = bool(np.all(values == np.round(values)))
    if not (whole or stated) or span < 50.0:
        return []
    wraps = bool(np.any(restarts(values)))
    # Of what is not called counts, 360 a turn are degrees.
    known = [n for n in COUNTS_PER_TURN if (stated or n != 360) and not _leaps(values, n)]
    full = [n for n in known if _FULL_SHARE * n <= span <= n]
    return [AngleUnit(counts=n) for n in (full if wraps and full else known)]


def _leaps(values: Array, a_turn: int) -> bool:
    """Whether counts (n,) that are not wrapped would go on by more than a third of a turn from row to row."""
    return bool(np.ptp(values) > 1.5 * a_turn and np.median(np.abs(np.diff(values))) > a_turn / 3.0)


def preferred(pairs: list[Pair]) -> list[Pair]:
    """Without those that no values could tell from a plainer one: both in the same unit, or both in equal counts."""
    for plain in (_BOTH_DEG, _BOTH_RAD):
        if plain in pairs:
            return [plain, *(pair for pair in pairs if pair[0] != pair[1])]
    return pairs
