"""Logs that list errors or corrections beside one angle: a protocol of a bench, or a table with its axis."""

from __future__ import annotations

import itertools

import numpy as np

from twin.angles import Array, wrap_deg
from twin.logs.angles import AngleUnit, options_of
from twin.logs.firmware import CORRECTION, ERROR
from twin.logs.lookups import Statement, correction_fits, entries_a_turn
from twin.logs.names import SURE, Meaning
from twin.logs.statement import Addend, Column
from twin.logs.table import Table

_CLOSE_STEPS = 1.5
"""By how many steps the angles of a table may miss a turn: the last one may repeat the first."""
_SIGN = {
    (ERROR, "measured_deg"): "-",
    (ERROR, "reference_deg"): "+",
    (CORRECTION, "measured_deg"): "+",
    (CORRECTION, "reference_deg"): "-",
}
"""By what is listed, and beside which angle: how it enters the other. An error is the reading less the true angle."""


def statements_of_errors(table: Table, said: tuple[Meaning, ...], usable: list[int]) -> list[Statement]:
    """The statements that make a sweep of an angle and what is listed beside it, the likeliest first; often none."""
    listed = [k for k in usable if said[k].role in (ERROR, CORRECTION)]
    axes = [k for k in usable if said[k].role == "angle"]
    axes = axes or [k for k in usable if k not in listed and _counts_rows(table.values[k])]
    return [
        one
        for axis, place in itertools.product(axes, listed)
        for unit in _units_of_axis(table.values[axis], said[axis])
        for side in _sides(said[axis])
        for one in _statements(table, said, (axis, place), unit, side)
    ]


def _counts_rows(values: Array) -> bool:
    return bool(np.array_equal(values, np.arange(values.size, dtype=np.float64)))


def _units_of_axis(values: Array, said: Meaning) -> list[AngleUnit]:
    """The units in which the values (n,) of an axis go round one turn, step by step in one direction."""
    known = values[np.isfinite(values)]
    if said.unit is not None:
        return [AngleUnit(said.unit.name)]
    options = [AngleUnit(counts=entries_a_turn(known))] if _counts_rows(known) else options_of(known, said)
    return [unit for unit in options if _goes_round(unit.degrees(known))]


def _goes_round(angle_deg: Array) -> bool:
    step = wrap_deg(np.diff(angle_deg))
    typical = float(np.median(np.abs(step)))
    missed = abs(abs(float(np.sum(step))) + typical - 360.0)
    return bool((np.all(step > 0.0) or np.all(step < 0.0)) and missed <= _CLOSE_STEPS * typical)


def _sides(said: Meaning) -> tuple[str, ...]:
    """Which angle the axis is: of the sensor, of the reference, or of either where its name does not tell."""
    if said.reference:
        return ("reference_deg",)
    return ("measured_deg",) if said.sensor == SURE else ("measured_deg", "reference_deg")


def _statements(
    table: Table, said: tuple[Meaning, ...], places: tuple[int, int], unit: AngleUnit, side: str
) -> list[Statement]:
    """The statement for an axis and what is listed beside it in its own unit, or in that of the axis."""
    axis, place = places
    own = said[place].unit
    of_list = unit if own is None else AngleUnit(own.name)
    if not correction_fits(table.values[place], of_list):
        return []
    entry = of_list.column("", table.sources[place])
    sign = _SIGN[said[place].role, side]
    known = unit.column(side, table.sources[axis])
    other = unit.column("measured_deg" if side == "reference_deg" else "reference_deg", table.sources[axis])
    moved = Column(other.target, other.term, other.unit, plus=Addend(sign, entry.term, entry.unit))
    return [(known, moved) if side == "reference_deg" else (moved, known)]
