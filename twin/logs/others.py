"""Columns beside the angles: time, speed, temperature and what else a sweep may hold, in whatever unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from twin.angles import Array, wrap_deg
from twin.logs.names import Meaning, meaning_of
from twin.logs.statement import Column, Term
from twin.logs.table import Table
from twin.logs.units import UNITS
from twin.sweep_columns import PLAUSIBLE, TOLD_BY_SENSOR

_TARGETS = {
    "time": "time_s",
    "speed": "speed_rpm",
    "temperature": "temperature_c",
    "gap": "air_gap_mm",
    "mounting": "mounting_deg",
    "turn": "turn",
    "direction": "direction",
    "current": "current_a",
    "magnitude": "magnitude",
    "agc": "agc",
    "status": "status",
    "frame": "frame",
}
_STANDARD = {"time": "s", "speed": "rpm", "temperature": "C", "gap": "mm", "mounting": "deg", "current": "A"}
_EPOCHS = (("s", 1e9, 1e10), ("ms", 1e12, 1e13), ("us", 1e15, 1e16), ("ns", 1e18, 1e19))
"""Seconds since 1970 lie between these from 2001 to 2286, in each unit."""
_WARMEST_C = 200.0
_MOST_WHOLE_A = 20.0
"""Whole numbers above this may be milliamperes."""


@dataclass(frozen=True)
class Found:
    """Columns of a sweep, what was taken for granted, and of columns that are left out by place the reason."""

    columns: tuple[Column, ...] = ()
    notes: tuple[str, ...] = ()
    why: Mapping[int, str] = field(default_factory=dict)


def target_of(name: str) -> str:
    """The column of a sweep, beside its angles, that the name of a log's column means; empty where it means none."""
    return _TARGETS.get(meaning_of(name).role, "")


def others(table: Table, said: tuple[Meaning, ...], usable: list[int], reference_deg: Array) -> Found:
    """The columns beside angles and channels; one whose unit nothing tells is left out, with what would take it."""
    columns: dict[str, Column] = {}
    notes: list[str] = []
    why: dict[int, str] = {}
    for k in sorted(usable, key=lambda place: (said[place].own is None, said[place].unit is None)):
        target = _TARGETS.get(said[k].role)
        if target is None:
            continue
        if target in columns:
            why[k] = f"{target} is taken from {columns[target].term.source}"
            continue
        column: Column | None
        if target in TOLD_BY_SENSOR:
            column, note = Column(target, Term(table.sources[k])), ""
        else:
            column, note = _read(table.sources[k], target, said[k], table.values[k], reference_deg)
        if column is None:
            why[k] = note
        else:
            columns[target] = column
            notes += [note] if note else []
    return Found(tuple(columns.values()), tuple(notes), why)


def _read(source: str, target: str, said: Meaning, values: Array, reference_deg: Array) -> tuple[Column | None, str]:
    """The column, and what was taken for granted; None and the reason where it cannot be read."""
    if target == "turn":
        whole = bool(np.all(values[np.isfinite(values)] % 1.0 == 0.0))
        return (Column(target, Term(source)), "") if whole else (None, "is no whole number: no number of a turn")
    if target == "direction":
        return _direction(source, values, reference_deg)
    unit, note = (said.unit.name, "") if said.unit else _unit(said.role, source, values)
    if not unit:
        return None, f"{note}; {Column(target, Term(source), 'UNIT')} takes it"
    column = Column(target, Term(source), None if unit == _STANDARD[said.role] else unit)
    low, high = PLAUSIBLE[target]
    read = values if column.unit is None else UNITS[column.unit].converted(values)
    known = read[np.isfinite(read)]
    if np.any((known < low) | (known > high)):
        return None, f"as {target} its values would lie outside {low:g} to {high:g}"
    if target in ("air_gap_mm", "mounting_deg") and np.ptp(known) > 0.0:
        return None, f"changes during the recording; {target} is one number for the whole"
    return column, note


def _direction(source: str, values: Array, reference_deg: Array) -> tuple[Column | None, str]:
    """+1 and -1 as they are; 0 and 1 by which way the reference moves."""
    levels = set(np.unique(values[np.isfinite(values)]).tolist())
    if levels <= {-1.0, 1.0}:
        return Column("direction", Term(source)), ""
    if levels <= {0.0, 1.0}:
        step = wrap_deg(np.diff(reference_deg))
        forward = float(np.nansum(np.sign(step) * (2.0 * values[1:] - 1.0)))
        sign = 1.0 if forward >= 0.0 else -1.0
        steps = (("*", 2.0 * sign), ("-" if sign > 0 else "+", 1.0))
        return Column("direction", Term(source, steps)), f"{source}: {int(sign > 0)} is forward, as the reference moves"
    return None, "holds other values than +1, -1 or 0, 1: no direction"


def _unit(role: str, source: str, values: Array) -> tuple[str, str]:
    """The unit that values tell, and what is to be said of it; no unit where they do not."""
    known = values[np.isfinite(values)]
    if role == "time":
        return _unit_of_time(source, known)
    if role == "temperature":
        unit = "C" if float(np.median(known)) <= _WARMEST_C else "K"
        return unit, f"{source} is taken in {unit}"
    if role == "speed":
        return "", "without a unit: rpm, rad/s, deg/s or rev/s"
    if role == "current" and np.all(known % 1.0 == 0.0) and np.max(np.abs(known)) > _MOST_WHOLE_A:
        return "", "whole numbers without a unit: A or mA"
    return _STANDARD[role], f"{source} is taken in {_STANDARD[role]}"


def _unit_of_time(source: str, known: Array) -> tuple[str, str]:
    for unit, low, high in _EPOCHS:
        if np.all((known >= low) & (known < high)):
            return unit, f"{source} is taken as {unit} since 1970"
    if np.any(known % 1.0 != 0.0):
        return "s", f"{source} is taken in s: it holds fractions"
    return "", "whole numbers without a unit: s, ms or us"
