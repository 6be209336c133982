"""How many times as fast the reading turns: pole pairs, gears, units, counts a turn, and which way it counts."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.harmonics import fitted, times_sure, waves
from diagnosis.setup.instant import read_late
from diagnosis.setup.record import Record
from diagnosis.setup.relation import Relation
from diagnosis.setup.sampling import even_points
from diagnosis.setup.step_change import steps_of
from twin.angles import Array, radians
from twin.following import spread_deg
from twin.logs.angles import AngleUnit, Pair, units_of_pair
from twin.logs.names import Meaning
from twin.words import Words

POLE_PAIRS = "pole_pairs"
"""The kind of what :func:`pole_pairs` finds."""
_LARGEST_TERM = 12
"""Of pole pairs and gears: a ratio of larger whole numbers is one of counts."""
_MOST_PAIRS = 128
"""Pole pairs of 2 mm on a ring 80 mm across: an alias of more is not thought of."""
_ALIKE = 1.5
"""An alias that leaves so many times as much is told from the ratio by the points' own unevenness."""
_WHOLE_TURNS = 0.9
"""On less of the turn an error of order 1 looks like a ratio."""
_NEAR, _FAR = 1e-3, 0.02
"""A ratio is near a simple one within its uncertainty, but at least and at most within these shares."""
_MOST_RADIANS = 64.0 * 2.0 * np.pi
"""More turns than this are degrees."""
_MORE_THAN_A_TURN_DEG = 370.0
_FEWEST_BY_ORDERS = 20
_MOST_WRONG_RAD = 1.5
_PARTED_TURNS, _FEWEST_PARTED = 1.2, 48
"""Turns and readings from which steps of the zero are told from a slope."""
_LEAST_OPEN_DEG, _MOST_OPEN_DEG = 0.25, 90.0
"""A turn that stays open by less may be a zero that drifts; by more no number of counts opens a word's turn."""
_COUNTS = (
    *(200, 256, 360, 400, 500, 512, 600, 720, 800, 1000, 1023, 1024, 1200, 1600, 2000, 2048, 2400, 2500, 3200, 3600),
    *(4000, 4095, 4096, 5000, 6400, 8000, 8192, 10000, 12000, 14400, 16000, 16383, 16384, 20000, 32768, 36000, 40000),
    *(65535, 65536),
)


def units(record: Record) -> Finding | None:
    """Angles in other units than those of their columns."""
    reference, measured = record.reference_deg, record.measured_deg
    if reference.size < 8 or any(column.across is not None for column in record.statement):
        return None
    spans = float(np.ptp(reference)), float(np.ptp(measured))
    pair = _other_units(record, spans) if min(spans) > 0.0 else None
    if pair is None:
        return None
    factors = [float(unit.degrees(np.ones(1))[0]) for unit in pair]
    sides = zip(("reference_deg", "measured_deg"), map(str, pair), strict=True)
    named = " and ".join(f"{name} in {unit}" for name, unit in sides if unit != "deg")
    return Finding(
        kind="units",
        what=f"the angles are not in degrees: {named}",
        evidence=f"they span {spans[0]:.4g} and {spans[1]:.4g}, and follow each other in these units alone",
        consequence="taken for degrees they are no sweep, or their error is that of the unit",
        remedy="say the unit",
        columns=record.stated(reference_deg=factors[0], measured_deg=factors[1]),
    )


def _other_units(record: Record, spans: tuple[float, float]) -> Pair | None:
    """The units in which the angles follow each other, where they do not in degrees."""
    relation = record.relation
    if relation is not None and relation.follows and not any(map(_wraps_elsewhere, record.angles)):
        radians = AngleUnit("rad")
        return (radians, radians) if max(spans) < _MOST_RADIANS and _by_radians(record) else None
    free = Meaning("angle")
    for pair in units_of_pair(record.reference_deg, record.measured_deg, said=(free, free)):
        known = all(
            unit.counts or unit.name == "deg" or (unit.name == "rad" and span < _MOST_RADIANS)
            for unit, span in zip(pair, spans, strict=True)
        )
        if known and {str(unit) for unit in pair} != {"deg"}:
            return pair
    return None


def _wraps_elsewhere(values: Array) -> bool:
    """Whether an angle (n,) begins anew after more than a turn of degrees: its turn is another number."""
    span = float(np.ptp(values))
    return span > _MORE_THAN_A_TURN_DEG and bool(np.any(np.abs(np.diff(values)) > 0.7 * span))


def _by_radians(record: Record) -> bool:
    """Whether the error of angles that follow each other repeats every 2 pi, or all of them lie within one of these."""
    reference, measured = record.reference_deg, record.measured_deg
    if max(np.ptp(reference), np.ptp(measured)) <= 1.02 * 2.0 * np.pi:
        return True
    relation = record.relation
    assert relation is not None
    # What errs by a degree or more errs by a turn if it is in radians.
    if reference.size < _FEWEST_BY_ORDERS or np.ptp(relation.error_deg) > _MOST_WRONG_RAD:
        return False
    one = np.ones_like(reference)
    error = measured - float(np.sign(relation.ratio)) * reference
    in_radians = np.mod(error + np.pi - np.median(error), 2.0 * np.pi)
    by_radians = fitted([one, *waves(reference, (1, 2))], in_radians).sigma
    return 3.0 * by_radians < fitted([one, *waves(np.radians(reference), (1, 2))], relation.error_deg).sigma


def counts_the_other_way(record: Record) -> Finding | None:
    """A reading that falls where the reference rises."""
    relation = record.relation
    if relation is None or relation.ratio >= 0.0 or units(record) is not None:
        return None
    by_channels = any(column.across is not None for column in record.statement)
    return Finding(
        kind="other_way",
        level="note",
        what="sensor and reference count opposite ways round"
        + (
            ": a flag of the sensor, its face turned to the other side, or sine and cosine swapped"
            if by_channels
            else ""
        ),
        evidence=f"the reading changes by {360.0 * relation.ratio:.1f} deg in a turn of the reference, over "
        f"{relation.turns:.2g} turns",
        consequence="explain and compensate take either sense; a motor's control with such a sensor runs away",
        remedy="set the direction in the sensor or the encoder, or count one of them the other way",
        columns=record.stated(reference_deg=-1.0),
    )


def _open_deg(relation: Relation) -> float | None:
    """By how much a turn stays open [deg]; None where it is closed within what is known."""
    off = 360.0 * (abs(relation.ratio) - 1.0)
    sure = 360.0 * relation.ratio_error * times_sure()
    return off if abs(off) > max(sure, _LEAST_OPEN_DEG) else None


def _simple(relation: Relation) -> Fraction | None:
    """The ratio as one of two small whole numbers other than 1; None where it is none."""
    ratio = abs(relation.ratio)
    near = Fraction(ratio).limit_denominator(_LARGEST_TERM)
    off = abs(ratio - float(near))
    allowed = min(max(times_sure() * relation.ratio_error, _NEAR * ratio), _FAR * ratio)
    if near == 1 or near == 0 or off > allowed or (near.denominator > 1 and near.numerator > 4 * _LARGEST_TERM):
        return None
    return near


def pole_pairs(record: Record) -> Finding | None:
    """A reading that turns a simple number of times as fast: electrical angles, pole pairs, a gear."""
    relation = record.relation
    if relation is None or units(record) is not None:
        return None
    simple = _simple(relation)
    if simple is None or (simple.denominator > 1 and simple.numerator > 1 and relation.turns < _WHOLE_TURNS):
        return None
    p, q = simple.numerator, simple.denominator
    rivals = _aliases(record, relation, p) if q == 1 else ()
    named = " or ".join(map(str, rivals))
    if q == 1:
        what = f"the reading turns {p} times as fast: an electrical angle of {p} pole pairs, or a {p}:1 gear before it"
    elif p == 1:
        what = (
            f"the reference turns {q} times as fast: an electrical angle of {q} pole pairs, or a {q}:1 gear before it"
        )
    else:
        what = f"the reading turns {p}/{q} times as fast: {p} pole pairs where {q} are assumed, or a {p}:{q} gear"
    return Finding(
        kind=POLE_PAIRS,
        what=what + (f"; or {named} pole pairs" if rivals else ""),
        evidence=f"{abs(relation.ratio):.4f} turns of the reading in one of the reference, over {relation.turns:.2g} "
        "of the latter" + (f"; {even_points(record)} even points a turn show {p} and {named} alike" if rivals else ""),
        consequence="the two columns do not tell the same angle, and no sweep can be made of them as they are",
        remedy="set the number of pole pairs or the gear ratio, or say it"
        + (
            f"; a dozen readings within one step tell {p} from {named}, or {2 * max(rivals) + 8} points a turn; until "
            f"then the statement holds for {p} alone"
            if rivals
            else ""
        ),
        columns=record.turned(measured_deg=p / q) if p > q else record.turned(reference_deg=q / p),
    )


def _aliases(record: Record, relation: Relation, times: int) -> tuple[int, ...]:
    """Other numbers of pole pairs that the points of the turn show like ``times``, in either sense of counting."""
    points = even_points(record)
    if points is None:
        return ()
    sense = float(np.sign(relation.ratio))
    left = spread_deg(record.measured_deg - sense * times * relation.travel_deg)
    found = []
    for rival in (times - points, times + points):
        other = spread_deg(record.measured_deg - sense * rival * relation.travel_deg)
        if times < abs(rival) <= _MOST_PAIRS and other < _ALIKE * left:
            found.append(abs(rival))
    return tuple(found)


def counts_a_turn(record: Record) -> Finding | None:
    """A turn that does not close by a constant factor: a wrong number of counts, or of steps."""
    relation = record.relation
    if relation is None or units(record) is not None or _simple(relation) is not None:
        return None
    if relation.turns < _WHOLE_TURNS or relation.travel_deg.size < 24 or read_late(record) is not None:
        return None
    opened = _open_deg(relation)
    ratio, of_reading = abs(relation.ratio), _is_of_the_reading(record)
    if opened is None:
        within = _within_a_turn(record)
        if within is None:
            return None
        ratio, opened, of_reading = within
    elif not _is_a_slope(relation):
        return None
    pairs = _pairs_of_counts(ratio, max(3.0 * relation.ratio_error, 1e-4))
    said = f"; {' or '.join(f'{a} counts taken for {b}' for a, b in pairs)} would do it" if pairs else ""
    side, factor = ("measured_deg", 1.0 / ratio) if of_reading else ("reference_deg", ratio)
    return Finding(
        kind="wrong_counts",
        what=f"a wrong number of counts or steps makes a turn, in {'the reading' if of_reading else 'one of the two'}",
        evidence=f"a turn of the reference is {360.0 * ratio:.2f} deg of the reading{said}",
        consequence=f"{abs(opened):.2f} deg are missing or too many in each turn, which no error of the sensor is",
        remedy="set the counts a turn where the log is written",
        columns=record.stated(**{side: round(factor, 6)}),
    )


def _is_of_the_reading(record: Record) -> bool:
    """Whether the factor goes from a word's 0, where the sensor's turn begins: then the reading is multiplied by it."""
    from twin.link.scale_error import find

    words = Words(radians(record.reference_deg), radians(record.measured_deg), np.ones(record.both.size, dtype=bool))
    return find(words) is not None


def _is_a_slope(relation: Relation) -> bool:
    """Whether a slope, and not a few steps of the zero, opens the turns."""
    if relation.turns < _PARTED_TURNS or relation.travel_deg.size < _FEWEST_PARTED:
        return True
    error, travel = relation.error_at_one_deg, relation.travel_deg
    by = [steps_of(error, travel, turn_of=turn) for turn in (travel, travel * abs(relation.ratio))]
    return min(one.slope_alone.sigma for one in by) <= min(one.alone.sigma for one in by)


def _within_a_turn(record: Record) -> tuple[float, float, bool] | None:
    """A factor that each turn begins anew with, as of a wrapped word: the ratio, and the degrees that are open.

    And whether it is the reading's.
    """
    relation = record.relation
    assert relation is not None
    if relation.turns < 1.5 or not relation.follows or relation.travel_deg.size < 48:
        return None
    for side, column in ((1.0, record.measured_deg), (-1.0, record.reference_deg)):
        if np.ptp(column) > 370.0 or np.ptp(column) < 300.0:
            continue
        turn = column / 360.0
        plain = [np.ones_like(turn), *waves(np.radians(relation.travel_deg), (1, 2, 3, 4))]
        fit = fitted([*plain, turn - float(np.mean(turn))], relation.error_deg)
        before = fitted(plain, relation.error_deg)
        opened = float(fit.values[-1])
        sure = abs(opened) > times_sure() * float(fit.errors[-1])
        if sure and _LEAST_OPEN_DEG < abs(opened) < _MOST_OPEN_DEG and fit.sigma < 0.5 * before.sigma:
            factor = 1.0 / (1.0 - opened / 360.0) if side > 0 else 1.0 + opened / 360.0
            return factor, opened, side > 0.0
    return None


def _pairs_of_counts(ratio: float, off: float) -> list[tuple[int, int]]:
    """Numbers of counts whose ratio it is, the closest first."""
    found = [
        (abs(a / b / ratio - 1.0), a, b)
        for a, b in itertools.permutations(_COUNTS, 2)
        if 0.5 < a / b < 2.0 and abs(a / b / ratio - 1.0) <= off
    ]
    return [(a, b) for _, a, b in sorted(found)[:2]]
