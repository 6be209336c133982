"""A log of one angle over time, without a reference: the sensor's own, in the unit in which it begins anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from twin.angles import Array
from twin.logs.angles import COUNTS_PER_TURN, TURN, AngleUnit
from twin.logs.asked_back import raise_open, raise_several, raise_untold
from twin.logs.channels import angle_of
from twin.logs.names import SURE, Meaning
from twin.logs.others import Found, others
from twin.logs.statement import Column, Term, text_of
from twin.logs.table import Table
from twin.logs.turn_seen import Turn, is_turn, turns_seen
from twin.sweep_columns import COLUMNS


def alone(table: Table, said: tuple[Meaning, ...], usable: Sequence[int], of_channels: Found) -> Found | None:
    """The columns of a log in which the sensor's readings stand alone over time; None where it is no such log.

    ``of_channels`` are ``vx`` and ``vy``, where the log holds them. Raises OpenGuess where the names and the values do
    not tell the unit of the angle or of the time.
    """
    named = [place for place, one in enumerate(said) if one.role == "angle"]
    if len(named) > 1 or any(place not in usable or said[place].reference >= SURE for place in named):
        return None
    if not named and len(of_channels.columns) != 2:
        return None
    if not any(said[place].role == "time" for place in usable):
        return None
    angles = [angle_of(of_channels.columns)] if not named else _of_values(table, said, named[0])
    beside = others(table, said, list(usable), angles[0].of(table))
    rest = (*of_channels.columns, *beside.columns)
    if not any(column.target == "time_s" for column in rest):
        _raise_unit_of_time(table, said, usable, (angles[0], *rest), beside)
        return None
    if len(angles) > 1:
        raise_several(table, [in_order((angle, *rest)) for angle in angles])
    notes = (*of_channels.notes, *beside.notes)
    return Found((angles[0], *rest), notes, {**of_channels.why, **beside.why})


def in_order(columns: Sequence[Column]) -> tuple[Column, ...]:
    """Columns in the order of the file format."""
    return tuple(sorted(columns, key=lambda one: COLUMNS.index(one.target)))


def units_seen(values: Array, said: Meaning) -> list[AngleUnit]:
    """The units in which the turn of an angle (n,) is that with which it begins anew; none where it does not."""
    whole = bool(np.all(values[np.isfinite(values)] % 1.0 == 0.0))
    return next((units for seen in turns_seen(values) if (units := _units_of(seen, said, whole=whole))), [])


def _units_of(seen: Turn, said: Meaning, *, whole: bool) -> list[AngleUnit]:
    named, counts = units_of_turn(seen, said.turns or COUNTS_PER_TURN)
    if said.counts or (whole and not any(unit.name == "deg" for unit in named)):
        return counts
    return named


def units_of_turn(seen: Turn, counts: Sequence[int] = COUNTS_PER_TURN) -> tuple[list[AngleUnit], list[AngleUnit]]:
    """The units of which a turn is as long as was seen: those that have a name, and counts a turn."""
    low, high = seen
    named = [AngleUnit(name) for name, turn in TURN.items() if is_turn(turn, seen)]
    return named, [AngleUnit(counts=n) for n in counts if low < n <= high]


def _of_values(table: Table, said: tuple[Meaning, ...], place: int) -> list[Column]:
    """The angle at a place in the unit of its name, else in those that its values show. Raises OpenGuess."""
    source, values, own = table.sources[place], table.values[place], said[place]
    units = units_seen(values, own if own.unit is None else replace(own, unit=None))
    if own.unit is not None:
        named = AngleUnit(own.unit.name)
        if not _contradicts(values, own, units):
            return [named.column("measured_deg", source)]
        other = units[0]
        what = f"{table.names[place]} is named in {named}, its values begin anew as those of {other} do"
        raise_open(table, what, [_with_time(table, said, other.column("measured_deg", source))])
    if units:
        return [unit.column("measured_deg", source) for unit in units]
    seen = turns_seen(values)
    if seen:
        turn = float(f"{seen[0][0]:.4g}")
        column = Column("measured_deg", Term(source, (("*", 360.0), ("/", turn))))
        what = f"{source} begins anew after about {turn:g}, which is the turn of no unit and of no encoder of the list"
        raise_open(table, what, [_with_time(table, said, column)])
    if own.counts or np.all(values[np.isfinite(values)] % 1.0 == 0.0):
        bare = Column("measured_deg", Term(source))
        what = (
            f"{source} goes from {np.nanmin(values):g} to {np.nanmax(values):g} and never begins anew: how many counts "
            "make a turn is not told by that"
        )
        raise_untold(table, what, _with_time(table, said, bare).replace(str(bare), f"{bare}*360/COUNTS"))
    return [AngleUnit(name).column("measured_deg", source) for name in ("deg", "rad", "rev")]


def _contradicts(values: Array, own: Meaning, units: list[AngleUnit]) -> bool:
    """Whether values (n,) begin anew as those of other units than the named one do."""
    if own.unit is None or not units:
        return False
    turn = 360.0 / own.unit.factor
    return not any(is_turn(turn, seen) for seen in turns_seen(values))


def _with_time(table: Table, said: tuple[Meaning, ...], angle: Column) -> str:
    """A statement of an angle and what stands beside it, where its unit is known."""
    usable = [place for place in range(len(said)) if place not in table.faults]
    beside = others(table, said, usable, angle.of(table))
    return text_of(in_order((angle, *beside.columns)))


def _raise_unit_of_time(
    table: Table, said: tuple[Meaning, ...], usable: Sequence[int], rest: tuple[Column, ...], beside: Found
) -> None:
    """Raise OpenGuess where the time lacks nothing but its unit: the spacing of a recording is nearest to ms."""
    place = next(place for place in usable if said[place].role == "time")
    if said[place].unit is not None:
        return
    step = abs(float(np.nanmedian(np.diff(table.values[place])))) or 1.0
    units = sorted({"s": 1.0, "ms": 1e-3, "us": 1e-6}.items(), key=lambda one: abs(np.log(one[1] * step / 1e-3)))
    options = [
        text_of(in_order((*rest, Column("time_s", Term(table.sources[place]), None if unit == "s" else unit))))
        for unit, _ in units
    ]
    raise_open(table, f"{table.sources[place]}: {beside.why.get(place, 'its unit is not told').split(';')[0]}", options)
