"""What the readings of a sensor alone and their time stamps tell of a set-up: the turn, the shaft's way, the clock."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.record import FEWEST, Record
from twin.logs.alone import units_of_turn
from twin.logs.angles import AngleUnit
from twin.logs.statement import Column, text_of
from twin.logs.turn_seen import Turn, is_turn, turns_seen
from twin.logs.units import UNITS
from twin.spin import why_no_turn

_EVEN, _EVEN_SHARE, _NEAR_WHOLE = 0.05, 0.9, 0.25
"""Stamps whose steps lie for the most part so near to the usual one are those of an even clock; readings are missing
from a step that is so nearly a whole number of usual ones. A late stamp makes any step."""


def other_turn(record: Record) -> Finding | None:
    """Readings that begin anew after another angle than a turn: another unit, or another number of counts."""
    measured = record.columns["measured_deg"]
    seen = turns_seen(measured)
    if not seen or any(is_turn(360.0, one) for one in seen):
        return None
    own = next((one for one in record.statement if one.target == "measured_deg"), None)
    meant = None if own is None else _meant(own, seen)
    if record.statement and meant is None:
        return None
    turns = 0.5 * sum(seen[0]) / 360.0
    counted = own is not None and bool(own.term.steps)
    what = "the reading begins anew after another angle than a turn"
    return Finding(
        kind="wrong_counts" if counted or own is None else "units",
        what=what if meant is None else f"{what}: it is in {meant[0]}",
        evidence=f"as it is read it goes from {np.nanmin(measured):.6g} to {np.nanmax(measured):.6g} deg and begins "
        f"anew there, after {turns:.4g} turns",
        consequence=f"what is told of a turn would be told of {1.0 / turns:.4g} of one, and its orders are others",
        remedy="say how many counts make a turn, or which unit it is; a sensor that counts several turns before it "
        "begins anew is right as it is",
        columns="" if meant is None else text_of(tuple(meant[1] if one is own else one for one in record.statement)),
    )


def _meant(own: Column, seen: Sequence[Turn]) -> tuple[AngleUnit, Column] | None:
    """The unit in which a column begins anew after a turn, and the column in it."""
    if own.across is not None or own.plus is not None or own.per is not None:
        return None
    scale = 1.0 if own.unit is None else UNITS[own.unit].factor
    for sign, number in own.term.steps:
        scale *= number if sign == "*" else 1.0 / number if sign == "/" else 1.0
    as_recorded = ((low / abs(scale), high / abs(scale)) for low, high in seen)
    unit = next((unit for one in as_recorded for units in units_of_turn(one) for unit in units), None)
    return None if unit is None else (unit, unit.column(own.target, own.term.source))


def no_turning(record: Record) -> Finding | None:
    """A shaft that stands still, or makes no whole turn."""
    measured = record.columns["measured_deg"]
    known = measured[np.isfinite(measured)]
    why = why_no_turn(known) if known.size >= FEWEST else None
    if why is None or other_turn(record) is not None:
        return None
    return Finding(
        kind="no_turning",
        what=f"by its readings {why}",
        evidence=f"{known.size} readings, one after another",
        consequence="without a reference an error is told by whole turns alone: there is none, and explain refuses it",
        remedy="let the shaft coast or turn steadily for some turns; or record a reference beside it",
    )


def gaps_in_time(record: Record) -> Finding | None:
    """Steps of an even clock that are longer than one reading: readings are missing."""
    time = record.columns["time_s"]
    rows = np.flatnonzero(np.isfinite(time))
    step = np.diff(time[rows])
    usual = float(np.median(step)) if step.size >= FEWEST else 0.0
    if usual <= 0.0 or np.mean(np.abs(step - usual) <= _EVEN * usual) < _EVEN_SHARE:
        return None
    many = step / usual
    long = np.flatnonzero((many > 2.0 - _NEAR_WHOLE) & (np.abs(many - np.round(many)) < _NEAR_WHOLE))
    if not long.size:
        return None
    missing = int(np.sum(np.round(many[long]) - 1.0))
    return Finding(
        kind="gaps_in_time",
        level="note",
        what="readings are missing",
        evidence=f"{long.size} gaps in stamps that are {usual:.4g} s apart otherwise; about {missing} readings",
        consequence="nothing is made up for them; behind a long gap a stretch of its own begins",
        remedy="read the recorder's buffer more often, where more readings are wanted",
        rows=tuple(int(row) for row in record.numbers[rows[long + 1]]),
    )


def by_reading(check: Callable[[Record], Finding | None]) -> Callable[[Record], Finding | None]:
    """A check of the clock for a sensor alone: the reading tells the shaft's way near enough for that."""

    def of_clock(record: Record) -> Finding | None:
        way = np.mod(record.columns["measured_deg"], 360.0)
        return check(replace(record, columns={**record.columns, "reference_deg": way}))

    return of_clock
