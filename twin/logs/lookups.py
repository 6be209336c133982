"""What the entries of a table mean, as the statement that makes a sweep of it: by the firmware, by names, by values."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from twin.angles import Array
from twin.errors import SweepError
from twin.logs.angles import AngleUnit, units_of_pair
from twin.logs.firmware import ANGLE, CORRECTION, ERROR, READING, TORQUES, Rule, is_known, rule_of
from twin.logs.names import SURE, Meaning, meaning_of
from twin.logs.own_tables import is_own, own_statements
from twin.logs.statement import Addend, Column, Term
from twin.logs.table import INDEX, LARGEST, Table
from twin.logs.units import UNITS

Statement = tuple[Column, Column]
_LARGEST_DEG, _SMALLEST_DEG = 25.0, 0.003
"""Half the span of a correction: a sensor that is farther off is corrected by no table, one that is less needs none."""
_FLOATS = ("rad", "deg", "rev")
_COUNTS = (16_384, 65_536, 4096, 32_768, 8192, 1024)
"""Counts a turn in which corrections are stored, those that are met most first."""
_ALIKE = 0.5
"""Correlation of an entry with the next from which a table without a name is taken for one of corrections."""
_CLOSED_SHARE = 0.25
"""A last entry that differs from the first by less than this share of a typical step repeats it."""


def statements_of(table: Table) -> tuple[list[Statement], tuple[str, ...]]:
    """The statements that fit a table of entries, and what is taken for granted in them.

    Raises SweepError where none does, with the reason.
    """
    places = _of_numbers(table)
    own, said = own_statements(table)
    if own:
        return own, said
    rules = [(k, rule) for k in places if (rule := rule_of(table.names[k], table.values[k]))]
    if rules:
        return [statement(table, k, rule) for k, rule in rules], (rules[0][1].said,)
    fitting = [one for k in places if not TORQUES.fullmatch(table.names[k]) for one in _by_values(table, k)]
    if fitting:
        return fitting, ("entries stand at even angles of one turn, the first at 0",)
    raise SweepError(f"{table.file}: {_why_none(table)}")


def _of_numbers(table: Table) -> list[int]:
    """The places of the arrays all of whose entries are numbers of a bench. Raises SweepError where those count."""
    wrong = {k: np.flatnonzero(~(np.abs(values) <= LARGEST)) for k, values in enumerate(table.values) if k}
    sound = [k for k, entries in wrong.items() if not entries.size]
    for k, entries in wrong.items():
        name = table.names[k]
        if entries.size and (not sound or is_known(name) or is_own(name, table.constants)):
            raise SweepError(
                f"{table.file}: {name}[{entries[0]}] is {table.values[k][entries[0]]:g}; expected numbers "
                f"within {LARGEST:g}: read the table out of the drive again"
            )
    return sound


def _why_none(table: Table) -> str:
    torques = [name for name in table.names[1:] if TORQUES.fullmatch(name)]
    if torques:
        return f"{torques[0]} holds torques against cogging, no angles; expected a table of angles, or a log"
    return (
        f"holds {len(table.values[0])} single numbers ({table.listed()}), neither angles of one turn nor corrections "
        "of angles; expected two or more numbers in each line, a reference and a sensor: export the log as CSV"
    )


def statement(table: Table, place: int, rule: Rule) -> Statement:
    """The statement that makes a sweep of the entries at a place, applied as a rule says."""
    count = entries_a_turn(table.values[place])
    half = 180.0 / count if rule.middle else 0.0
    even = (("*", 360.0), ("/", float(count)))
    grid = Term(INDEX, (*even, ("+", half)) if half else even)
    entry = Term(table.sources[place], rule.factors)
    if rule.holds == ANGLE:
        return Column("reference_deg", entry, rule.unit), Column("measured_deg", grid)
    if rule.holds == READING:
        return Column("reference_deg", grid), Column("measured_deg", entry, rule.unit)
    plus = Addend("-" if rule.holds == ERROR else "+", entry, rule.unit)
    moved = half + rule.addend
    first = Term(INDEX, (*even, ("+", moved)) if moved else even)
    return Column("reference_deg", first, plus=plus), Column("measured_deg", grid)


def entries_a_turn(entries: Array) -> int:
    """How many entries (n,) make a turn: all, or one less where the last repeats the first."""
    step = float(np.median(np.abs(np.diff(entries))))
    closed = entries.size % 2 == 1 and abs(float(entries[-1] - entries[0])) <= _CLOSED_SHARE * step
    return entries.size - 1 if closed else entries.size


def _by_values(table: Table, place: int) -> Iterator[Statement]:
    """The statements that the values and the name of a column of entries leave open, the likeliest first."""
    # Of a path it is the last word that says what the entries are.
    said, entries = meaning_of(table.names[place].rpartition(".")[2]), table.values[place]
    grid_deg = np.arange(entries.size) * 360.0 / entries.size
    angle = Meaning("angle", unit=said.unit, counts=said.counts)
    units = [pair[1] for pair in units_of_pair(grid_deg, entries, said=(meaning_of("index_deg"), angle))]
    if units:
        for holds in (READING,) if said.sensor == SURE else (ANGLE,) if said.reference == SURE else (ANGLE, READING):
            yield from (statement(table, place, _rule(holds, unit)) for unit in units)
        return
    if not said.role and _unlike_next(entries):
        return
    for unit in _units_of_correction(entries, said):
        for holds in (said.role,) if said.role in (ERROR, CORRECTION) else (ERROR, CORRECTION):
            yield statement(table, place, _rule(holds, unit))


def _unlike_next(entries: Array) -> bool:
    """Whether entries (n,) round a turn tell nothing of those beside them, as numbers that are no corrections do."""
    off = entries - np.mean(entries)
    return float(np.sum(off * np.roll(off, 1))) < _ALIKE * float(np.sum(off * off))


def _rule(holds: str, unit: AngleUnit) -> Rule:
    if unit.counts:
        return Rule("", holds, factors=(("*", 360.0), ("/", float(unit.counts))))
    return Rule("", holds, unit=None if unit.name == "deg" else unit.name)


def _units_of_correction(entries: Array, said: Meaning) -> list[AngleUnit]:
    """The units in which entries (n,) are corrections of an angle, of a size that a sensor may need."""
    whole = bool(np.all(entries % 1.0 == 0.0))
    if said.unit is not None:
        options = [AngleUnit(said.unit.name)]
    elif whole or said.counts:
        options = [AngleUnit(counts=n) for n in _COUNTS]
    else:
        options = [AngleUnit(name) for name in _FLOATS]
    return [one for one in options if correction_fits(entries, one)]


def correction_fits(entries: Array, unit: AngleUnit) -> bool:
    """Whether entries (n,), in a unit, are as large as what a sensor may need."""
    step_deg = UNITS[unit.name].factor if unit.name else 360.0 / unit.counts
    half_span = float(np.nanmax(entries) - np.nanmin(entries)) / 2.0
    return _SMALLEST_DEG <= half_span * step_deg <= _LARGEST_DEG
