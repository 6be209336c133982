"""How the turn is sampled: too few points, a part of it left out, lines that may stand in for faster ones."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.harmonics import FALSE_ALARM, fitted, waves
from diagnosis.setup.record import FEWEST, Record
from twin.angles import Array

FEWEST_ANGLES = 12
"""Orders 0 to 4 of the error model have nine parameters, and some angles must be left to judge them by."""
_HIGHEST_ORDER = 200
"""Teeth, slots, poles and steps of a turn make lines up to here; an alias of a higher one is not thought of."""
_FEW_POINTS, _LOW = 100, 8
"""Points a turn up to which any order above 4 may be another; of more, orders above the second that are near it."""
_SHARE_OF_LINE = 0.3
"""Share of what orders 1 to 4 leave that a line explains at least: slips and bursts have many, and no alias."""
_SAME_DEG = 0.05
_LEAST_LINE_DEG = 1e-3
"""Below it no sensor of angles resolves a line: the last digits of a file make such."""
_ON_GRID = 0.01
"""Share of a step by which a reading may miss it: cells of a file have nine digits."""
_EVEN = 0.02
_EVEN_ANGLES = 0.08
"""Share of a step by which even angles or times may scatter: so little hardly parts a line from its alias."""
_MAINS_HZ = (50.0, 60.0, 100.0, 120.0)
_FASTEST_HZ = 1000.0
"""Readings a second up to which supplies, motors and vibration make lines above half of it."""
_LEAST_GAP_DEG = 60.0


def _angles(record: Record) -> Array:
    """The different angles within the turn [deg], ascending."""
    at = np.sort(np.mod(record.reference_deg, 360.0))
    if at.size < 2:
        return at
    gaps = np.diff(at)
    # What is much closer than usual is one angle, met again in another turn.
    apart = gaps > max(_SAME_DEG, 0.25 * float(np.median(gaps)))
    closed = at[0] + 360.0 - at[-1] > _SAME_DEG
    return np.asarray(at[np.concatenate([[closed or apart.sum() == 0], apart])])


def even_points(record: Record) -> int | None:
    """How many even points make the turn; None where they are not even."""
    angles = _angles(record)
    gaps = np.diff(angles, append=angles[0] + 360.0) if angles.size > 1 else np.zeros(0)
    return angles.size if gaps.size and np.ptp(gaps) <= _EVEN_ANGLES * 360.0 / angles.size else None


def few_points(record: Record) -> Finding | None:
    """Fewer angles in the turn than the error model's orders need."""
    if record.both.size < 2:
        return None
    angles = _angles(record)
    if angles.size >= FEWEST_ANGLES:
        return None
    return Finding(
        kind="few_points",
        what="too few angles in the turn",
        evidence=f"{angles.size} different ones: orders above {max(angles.size // 2 - 1, 0)} look like lower ones",
        consequence=f"the error model (orders up to 4) needs {FEWEST_ANGLES}; whatever is named may be another order",
        remedy="record at least 36 angles a turn, or several turns at angles between those of the first",
    )


def part_of_a_turn(record: Record) -> Finding | None:
    """A turn of which a part was never visited."""
    if record.both.size < FEWEST:
        return None
    angles = _angles(record)
    gaps = np.diff(angles, append=angles[0] + 360.0)
    widest = int(np.argmax(gaps))
    usual = float(np.median(gaps))
    if gaps[widest] < max(_LEAST_GAP_DEG, 4.0 * usual):
        return None
    return Finding(
        kind="part_of_a_turn",
        level="note",
        what="the turn is not closed: a part of it was not recorded",
        evidence=f"no reading between {angles[widest]:.0f} and {(angles[widest] + gaps[widest]) % 360.0:.0f} deg of "
        "the reference",
        consequence="offset, gain and the orders cannot be parted well, and a correction does not hold there",
        remedy="record a whole turn",
    )


def aliased_order(record: Record) -> Finding | None:
    """A line of the turn that even points cannot tell from a faster one."""
    relation = record.relation
    if relation is None or not relation.follows or relation.turns < 0.9:
        return None
    points = even_points(record)
    if points is None or not 2 * FEWEST <= points <= 2 * _HIGHEST_ORDER:
        return None
    found = _strongest_order(np.radians(relation.travel_deg), relation.error_deg, points)
    if found is None:
        return None
    order, amplitude = found
    rivals = [one for one in (points - order, points + order) if one <= _HIGHEST_ORDER]
    # A coarse word read at even angles makes lines, each below its step.
    least = max(*map(step_of_word, record.angles), _LEAST_LINE_DEG)
    if not rivals or amplitude < least or not _may_be_another(order, points):
        return None
    return Finding(
        kind="aliased_order",
        level="note",
        what=f"order {order} may be order {' or '.join(map(str, rivals))}",
        evidence=f"{points} even points a turn show both alike; the line has an amplitude of {amplitude:.3g} deg",
        consequence="a line above half the points a turn is named by the wrong order, and its cause with it",
        remedy=f"record at least {2 * max(rivals) + 8} points a turn, or at uneven angles",
    )


def _may_be_another(order: int, points: int) -> bool:
    """Whether a line is thought to stand for a faster one: low orders are the field's own, multiples of 4 clipping's.

    Of fine grids the rival is far above whatever else there is, unless the line is near it.
    """
    return order % 4 != 0 if points <= _FEW_POINTS else order > _LOW and 4 * order >= points


def step_of_word(measured_deg: Array) -> float:
    """The step of the shortest word that all readings are on; 0 where they are on none."""
    for bits in range(6, 17):
        steps = measured_deg * 2.0**bits / 360.0
        if np.ptp(measured_deg) > 0.0 and np.all(np.abs(steps - np.round(steps)) < _ON_GRID):
            return float(360.0 / 2.0**bits)
    return 0.0


def _strongest_order(shaft_rad: Array, error_deg: Array, points: int) -> tuple[int, float] | None:
    """The strongest order above 4 and below half the points, where it is no chance."""
    from scipy.stats import f

    low = [np.ones_like(shaft_rad), *waves(shaft_rad, (1, 2, 3, 4))]
    left = fitted(low, error_deg).left
    turns = float(np.ptp(shaft_rad)) / (2.0 * np.pi)
    orders = np.arange(5, (points + 1) // 2)
    if orders.size < 4 or left.size <= len(low) + 4:
        return None
    sums = np.array([abs(np.sum(left * np.exp(-1j * order * shaft_rad))) for order in orders])
    best = int(orders[int(np.argmax(sums))])
    # A line in time lies between the orders, where there are turns enough to see it.
    near = best + np.linspace(-0.5, 0.5, 41)
    close = [abs(np.sum(left * np.exp(-1j * order * shaft_rad))) for order in near]
    if turns > 1.8 and abs(float(near[int(np.argmax(close))]) - best) > 0.3 / turns:
        return None
    fit = fitted([*low, *waves(shaft_rad, (best,))], error_deg)
    free = left.size - len(low) - 2
    gained = (float(np.sum(left**2)) - float(np.sum(fit.left**2))) / 2.0
    p = float(f.sf(gained / max(float(np.sum(fit.left**2)) / free, 1e-300), 2, free)) * orders.size
    strong = 2.0 * gained > _SHARE_OF_LINE * float(np.sum(left**2))
    return (best, float(np.hypot(*fit.values[-2:]))) if strong and p < FALSE_ALARM else None


def aliased_frequency(record: Record) -> Finding | None:
    """A line in time that may be another above half of the sampling rate: the mains, or one near the rate."""
    relation, time = record.relation, record.column("time_s")
    if relation is None or not relation.follows or time is None or time.size < 64 or not np.isfinite(time).all():
        return None
    step = np.diff(time)
    usual = float(np.median(step))
    if usual <= 0.0 or np.max(np.abs(step - usual)) > _EVEN * usual or 1.0 / usual > _FASTEST_HZ:
        return None
    rate = 1.0 / usual
    seen = _strongest_frequency(record, time - time[0], relation.error_deg, rate)
    if seen is None:
        return None
    frequency, amplitude, width = seen
    if amplitude < max(*map(step_of_word, record.angles), _LEAST_LINE_DEG):
        return None
    rival = _rival(frequency, rate, width, turns_a_second=relation.turns / max(float(np.ptp(time)), 1e-12))
    if not rival:
        return None
    return Finding(
        kind="aliased_frequency",
        level="note",
        what=f"the line at {frequency:.3g} Hz may be {rival}",
        evidence=f"{rate:.4g} readings a second show both alike; its amplitude is {amplitude:.3g} deg",
        consequence="what is above half the sampling rate shows at a lower frequency, and is named by it",
        remedy="read several times as often, or at another rate: an alias then moves",
    )


def _rival(frequency: float, rate: float, width: float, *, turns_a_second: float) -> str:
    """What a line may stand for in words: the mains, or its mirror image at the sampling rate; empty for neither."""
    for mains in _MAINS_HZ:
        apparent = abs(mains - rate * round(mains / rate))
        if mains > 0.5 * rate and abs(apparent - frequency) <= 0.25 * width:
            return f"{mains:g} Hz, the mains"
    order = frequency / turns_a_second if turns_a_second > 0.0 else 0.5
    of_the_turn = abs(order - round(order)) * turns_a_second <= 0.3 * width
    return f"{rate - frequency:.3g} Hz" if frequency > 0.25 * rate and not of_the_turn else ""


def _strongest_frequency(record: Record, time: Array, error: Array, rate: float) -> tuple[float, float, float] | None:
    """The strongest line in time, where it is no chance: Hz, deg, and the width of a line in Hz."""
    from scipy.stats import f

    relation = record.relation
    assert relation is not None
    shaft = np.radians(relation.travel_deg)
    low = [np.ones_like(time), *waves(shaft, (1, 2, 3, 4))]
    left = fitted(low, error).left
    spectrum = np.abs(np.fft.rfft(left, 4 * left.size))
    hertz = np.fft.rfftfreq(4 * left.size, 1.0 / rate)
    width = rate / left.size
    spectrum[hertz < 2.0 * width] = 0.0
    coarse = float(hertz[int(np.argmax(spectrum))])
    near = coarse + np.linspace(-0.25, 0.25, 41) * width
    best = float(near[int(np.argmax([abs(np.sum(left * np.exp(-2j * np.pi * one * time))) for one in near]))])
    fit = fitted([*low, *waves(2.0 * np.pi * time, (best,))], error)
    free = left.size - len(low) - 2
    gained = (float(np.sum(left**2)) - float(np.sum(fit.left**2))) / 2.0
    p = float(f.sf(gained / max(float(np.sum(fit.left**2)) / free, 1e-300), 2, free)) * left.size
    return (best, float(np.hypot(*fit.values[-2:])), width) if p < FALSE_ALARM else None
