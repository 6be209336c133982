"""Turns that do not come back to where they began: slips of the reference, lost counts, a magnet that turns."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.harmonics import FALSE_ALARM, waves
from diagnosis.setup.instant import read_late
from diagnosis.setup.ratio import counts_a_turn
from diagnosis.setup.record import Record
from diagnosis.setup.step_change import steps_of
from twin.angles import Array

_LEAST_DEG = 0.5
"""A zero that steps by less is a bench's: warmth, a counter set to zero anew at its index."""
_DRIFTS_WITH = ("temperature_c", "current_a")
_POWERS = 3
"""Of the time that a warming, or a current that rises, may go by."""


def turn_not_closed(record: Record) -> Finding | None:
    """A zero that steps along the record, so that the reading does not come back to where it was."""
    from scipy.stats import norm

    relation = record.relation
    if relation is None or not relation.follows or relation.turns < 1.2 or record.both.size < 48:
        return None
    if counts_a_turn(record) is not None or read_late(record) is not None:
        return None
    travel = relation.travel_deg
    found = steps_of(relation.error_at_one_deg, travel, turn_of=record.measured_deg, beside=_drifts(record))
    sigmas = float(norm.isf(FALSE_ALARM / (2.0 * travel.size)))

    def told(place: int, size: float, error: float) -> bool:
        return abs(size) >= max(_LEAST_DEG, sigmas * error) and found.is_sudden(place)

    steps = found.lasting()
    # Where the largest is none, the smaller ones are pieces of the same drift.
    if not steps or not told(*steps[0]):
        return None
    steps = sorted(step for step in steps if told(*step))
    rows = record.rows(np.array([place for place, _, _ in steps]))
    said = ", ".join(f"at row {row} by {size:+.2f} deg" for row, (_, size, _) in zip(rows, steps, strict=True))
    return Finding(
        kind="turn_not_closed",
        what="a turn does not close: the reading does not come back to where it was",
        evidence=f"the zero steps {said}, and stays there",
        consequence="the reference has lost counts or slipped, or the magnet has turned on its shaft",
        remedy="check couplings, set screws and the reference's counter; record again, or explain the part before it",
        rows=rows,
    )


def _drifts(record: Record) -> list[Array]:
    """Shapes (n,) in which a zero and an order 1 may change smoothly: with the rows, the temperature, the current."""
    along = np.linspace(-1.0, 1.0, record.both.size)
    ways = [along**power for power in range(1, _POWERS + 1)]
    for name in _DRIFTS_WITH:
        column = record.column(name)
        if column is not None and np.isfinite(column).all() and np.ptp(column) > 0.0:
            ways.append(np.asarray((column - np.mean(column)) / np.std(column)))
    once = waves(np.radians(record.measured_deg), (1,))
    return [way * shape for way in ways for shape in (np.ones_like(along), *once)]
