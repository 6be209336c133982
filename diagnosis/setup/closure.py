"""Turns that do not come back to where they began: slips of the reference, lost counts, a magnet that turns."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.harmonics import FALSE_ALARM
from diagnosis.setup.ratio import counts_a_turn
from diagnosis.setup.record import Record
from diagnosis.setup.step_change import steps_of

_LEAST_DEG = 0.25
"""A zero that steps by less is the drift of a bench."""
_NEAR_ROWS = 12
"""Rows before and after a place that tell whether the shaft turned round there."""


def turn_not_closed(record: Record) -> Finding | None:
    """A zero that steps along the record, so that the reading does not come back to where it was."""
    from scipy.stats import norm

    relation = record.relation
    if relation is None or not relation.follows or relation.turns < 1.2 or record.both.size < 48:
        return None
    if counts_a_turn(record) is not None:
        return None
    travel = relation.travel_deg
    found = steps_of(relation.error_at_one_deg, travel, turn_of=record.measured_deg)
    place, size, error = found.largest()
    sure = float(norm.isf(FALSE_ALARM / (2.0 * travel.size))) * error
    # Where the shaft turns round, play and hysteresis step.
    step = np.sign(np.diff(travel))
    before, after = step[max(place - _NEAR_ROWS, 0) : place - 2], step[place + 1 : place + _NEAR_ROWS]
    turned = before.size and after.size and float(np.median(before)) != float(np.median(after))
    if turned or abs(size) < max(_LEAST_DEG, sure):
        return None
    rows = record.rows(np.array([place]))
    return Finding(
        kind="turn_not_closed",
        what="a turn does not close: the reading does not come back to where it was",
        evidence=f"at row {rows[0]} the zero steps by {size:+.2f} deg, and stays there",
        consequence="the reference has lost counts or slipped, or the magnet has turned on its shaft",
        remedy="check couplings, set screws and the reference's counter; record again, or explain the part before it",
        rows=rows,
    )
