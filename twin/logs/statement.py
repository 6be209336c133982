"""What ``--columns`` says: which column of a log becomes which of a sweep, by which factor and unit.

``reference_deg=enc_counts*360/40000, measured_deg=angle:rad``: a column of the sweep, a column of the log by its name,
by its name in single quotes, or by its place (``#3``); then factors, at most one addend, and a unit; then at most one
more column, its factors and its unit behind a plus or a minus. ``measured_deg=atan2(sin, cos)`` is the angle of two
channels, ``measured_deg=unwrap(theta_e:rad)/7`` an angle that turns seven times a turn, followed over its turns.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from twin.angles import Array
from twin.errors import UserError
from twin.logs.table import Table
from twin.logs.units import QUANTITY, UNITS
from twin.shown import shown
from twin.sweep_columns import COLUMNS, lacking

_NAME = r"#\d+|[^\W\d]\w*(?:\.\w+)*|'(?:[^']|'')+'"
_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_TERM = re.compile(rf"\s*({_NAME})((?:\s*[*/]\s*-?{_NUMBER})*)(\s*[+-]\s*{_NUMBER})?\s*")
_STEP = re.compile(rf"([*/+-])\s*(-?{_NUMBER})")
_BARE = re.compile(r"[^\W\d]\w*(?:\.\w+)*")
_UNQUOTED = re.compile(r"[^\x00-\x1f'\"$`\\!]+")
_BRACKETS = r"\((?:'[^']*'|[^()'])*\)"
_ITEM = re.compile(rf"(?:'[^']*'|\((?:'[^']*'|{_BRACKETS}|[^()'])*\)|[^,'(])+|[^,]")
_UNIT = re.compile(r"\s*:\s*([^\s:+-]+)\s*")
_UNWRAPPED = re.compile(rf"\s*unwrap\s*\((.*)\)\s*/\s*({_NUMBER})\s*")
_SECOND = re.compile(r"\s*([+-])(.*)", re.DOTALL)
EXAMPLE = "reference_deg=enc_counts*360/40000, measured_deg=angle:rad"


@dataclass(frozen=True)
class Term:
    """A column of a log with what is done to its values, one step after the other; a source is a name or ``#3``."""

    source: str
    steps: tuple[tuple[str, float], ...] = ()

    def of(self, table: Table) -> Array:
        """The values (n,). Raises SweepError for a column that is not there or holds words."""
        values = table.values_of(self.source)
        for sign, number in self.steps:
            step = {"*": np.multiply, "/": np.divide, "+": np.add, "-": np.subtract}[sign]
            values = step(values, number)
        return values

    def __str__(self) -> str:
        bare = self.source.startswith("#") or _BARE.fullmatch(self.source)
        name = self.source if bare else f"'{self.source.replace(chr(39), 2 * chr(39))}'"
        return name + "".join(f"{sign}{number:.15g}" for sign, number in self.steps)


@dataclass(frozen=True)
class Addend:
    """A second column of a log that is added (``+``) to a first or taken off it (``-``), in a unit of its own."""

    sign: str
    term: Term
    unit: str | None = None

    def of(self, table: Table) -> Array:
        """What is added (n,), in the unit of the sweep's column. Raises SweepError."""
        values = _in_unit(self.term.of(table), self.unit)
        return values if self.sign == "+" else -values

    def __str__(self) -> str:
        return f"{self.sign}{_with_unit(self.term, self.unit)}"


@dataclass(frozen=True)
class Column:
    """One column of the sweep: a term and its unit, or the angle of two terms (``across`` is the second channel).

    ``plus`` is a second term that is added to it. ``per`` is how often the angle turns in a turn of the shaft: it is
    followed over its turns and divided by it.
    """

    target: str
    term: Term
    unit: str | None = None
    across: Term | None = None
    plus: Addend | None = None
    per: float | None = None

    def of(self, table: Table) -> Array:
        """The values (n,) in the unit of the sweep's column. Raises SweepError."""
        values = self.term.of(table)
        if self.across is not None:
            values = np.degrees(np.arctan2(values, self.across.of(table)))
        else:
            values = _in_unit(values, self.unit)
        if self.plus is not None:
            values = values + self.plus.of(table)
        return values if self.per is None else unwrapped_deg(values) / self.per

    @property
    def sources(self) -> tuple[str, ...]:
        """The columns of the log that it is made of."""
        further = (self.across, None if self.plus is None else self.plus.term)
        return (self.term.source, *(term.source for term in further if term is not None))

    def __str__(self) -> str:
        text = _with_unit(self.term, self.unit) if self.across is None else f"atan2({self.term}, {self.across})"
        text += "" if self.plus is None else str(self.plus)
        return f"{self.target}={text if self.per is None else f'unwrap({text})/{self.per:.15g}'}"


def unwrapped_deg(angle_deg: Array) -> Array:
    """An angle (n,) [deg] over its turns from row to row; rows without one stay so and interrupt nothing."""
    known = np.isfinite(angle_deg)
    followed = np.full(angle_deg.shape, np.nan)
    followed[known] = np.unwrap(angle_deg[known], period=360.0)
    return followed


def _in_unit(values: Array, unit: str | None) -> Array:
    return values if unit is None else UNITS[unit].converted(values)


def _with_unit(term: Term, unit: str | None) -> str:
    return f"{term}{'' if unit is None else f':{unit}'}"


def can_be_quoted(name: str) -> bool:
    """Whether a column's name can stand in single quotes in a shell's double quotes; others go by their place."""
    return _UNQUOTED.fullmatch(name) is not None and name == name.strip()


def text_of(columns: tuple[Column, ...]) -> str:
    """A statement as ``--columns`` takes it."""
    return ", ".join(map(str, columns))


def values_of(columns: tuple[Column, ...], table: Table) -> Mapping[str, Array]:
    """The columns (n,) of the sweep. Raises SweepError."""
    return {column.target: column.of(table) for column in columns}


def parsed(text: str) -> tuple[Column, ...]:
    """A statement from its text. Raises UserError."""
    columns = tuple(_column(item) for item in _items(text))
    targets = [column.target for column in columns]
    for target in targets:
        if targets.count(target) > 1:
            raise UserError(f"--columns: {target} is said {targets.count(target)} times; expected it once: keep one")
    if missing := lacking(targets, spin=True):
        raise UserError(f"--columns: {missing.removeprefix('column ')}; say which column it is, e.g. {EXAMPLE!r}")
    return columns


def _items(text: str) -> list[str]:
    """What stands between commas, but for those inside quotes and brackets."""
    return [item for item in _ITEM.findall(text) if item.strip()]


def _column(item: str) -> Column:
    target, equals, rest = item.partition("=")
    target = target.strip()
    if not equals:
        raise UserError(f"--columns: {shown(item.strip())}: expected COLUMN=NAME, e.g. {EXAMPLE!r}")
    if target not in COLUMNS:
        raise UserError(f"--columns: {shown(target)} is no column of a sweep; expected one of {', '.join(COLUMNS)}")
    turned = _UNWRAPPED.fullmatch(rest) if QUANTITY.get(target) == "angle" else None
    if turned and float(turned[2]) == 0.0:
        raise UserError(f"--columns: {shown(item.strip(), 80)}: {turned[2]} is no factor; expected a number but 0")
    column = _sum(target, turned[1] if turned else rest, item)
    return column if turned is None else replace(column, per=float(turned[2]))


def _sum(target: str, rest: str, item: str) -> Column:
    """A term or the angle of two, and what is added to it."""
    pair = re.fullmatch(r"\s*atan2\s*\((.*)\)\s*", rest)
    if pair and QUANTITY.get(target) == "angle":
        terms = [_term(part, item)[0] for part in _items(pair[1])]
        if len(terms) != 2:
            raise UserError(f"--columns: {shown(item.strip())}: expected two channels, e.g. {target}=atan2(sin, cos)")
        return Column(target, terms[0], across=terms[1])
    term, more = _term(rest, item, whole=False)
    unit, more = _unit(more, target, item)
    second = _SECOND.fullmatch(more)
    if not second:
        return Column(target, term, unit=unit)
    added, more = _term(second[2], item, whole=False)
    added_unit, more = _unit(more, target, item)
    if more.strip() or any(sign in "+-" for sign, _ in added.steps):
        raise UserError(
            f"--columns: {shown(item.strip(), 80)}: more than two columns, or a number behind the second; expected at "
            "most two, the number behind the first, e.g. 'reference_deg=index*360/64-2.5-lut:rad'"
        )
    return Column(target, term, unit=unit, plus=Addend(second[1], added, added_unit))


def _term(text: str, item: str, *, whole: bool = True) -> tuple[Term, str]:
    """A term, and what stands behind it. Raises UserError for what is none, and for more where it is the ``whole``."""
    found = _TERM.match(text)
    if not found or (whole and found.end() < len(text)):
        raise UserError(
            f"--columns: {shown(item.strip(), 80)}: expected a column's name, factors, one addend and a unit, "
            "e.g. 'vx=ch1-2048' or 'measured_deg=angle*2:rad'; a name with other characters goes in single quotes"
        )
    name = found[1][1:-1].replace("''", "'") if found[1].startswith("'") else found[1]
    steps = tuple((sign, float(number)) for sign, number in _STEP.findall(f"{found[2]}{found[3] or ''}"))
    for sign, number in steps:
        if not np.isfinite(number) or (sign in "*/" and number == 0.0):
            raise UserError(f"--columns: {shown(item.strip(), 80)}: {number:g} is no factor; expected a number but 0")
    return Term(name, steps), text[found.end() :]


def _unit(text: str, target: str, item: str) -> tuple[str | None, str]:
    """The unit behind a term, None where nothing stands there, and what follows. Raises UserError."""
    if not text.strip() or _SECOND.fullmatch(text):
        return None, text
    found = _UNIT.match(text)
    fitting = [name for name, unit in UNITS.items() if unit.quantity == QUANTITY.get(target)]
    rest = text[found.end() :] if found else ""
    if not found or found[1] not in fitting or (rest and not _SECOND.fullmatch(rest)):
        units = f"one of {', '.join(fitting)} behind a colon" if fitting else f"none, as {target} has no unit"
        raise UserError(f"--columns: {shown(item.strip(), 80)}: found {shown(text.strip())} as unit; expected {units}")
    return found[1], rest
