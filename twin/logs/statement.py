"""What ``--columns`` says: which column of a log becomes which of a sweep, by which factor and unit.

``reference_deg=enc_counts*360/40000, measured_deg=angle:rad``: a column of the sweep, a column of the log by its name,
by its name in single quotes, or by its place (``#3``); then factors, at most one addend, and a unit.
``measured_deg=atan2(sin, cos)`` is the angle of two channels.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.errors import UserError
from twin.logs.table import Table
from twin.logs.units import QUANTITY, UNITS
from twin.shown import shown
from twin.sweep_columns import COLUMNS, REQUIRED

_NAME = r"#\d+|[^\W\d]\w*(?:\.\w+)*|'(?:[^']|'')+'"
_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_TERM = re.compile(rf"\s*({_NAME})((?:\s*[*/]\s*-?{_NUMBER})*)(\s*[+-]\s*{_NUMBER})?\s*")
_STEP = re.compile(rf"([*/+-])\s*(-?{_NUMBER})")
_BARE = re.compile(r"[^\W\d]\w*(?:\.\w+)*")
_UNQUOTED = re.compile(r"[^\x00-\x1f'\"$`\\!]+")
_ITEM = re.compile(r"(?:'[^']*'|\((?:'[^']*'|[^()'])*\)|[^,'(])+|[^,]")
_UNIT = re.compile(r"\s*:\s*([^\s:]+)\s*")
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
class Column:
    """One column of the sweep: a term and its unit, or the angle of two terms (``across`` is the second channel)."""

    target: str
    term: Term
    unit: str | None = None
    across: Term | None = None

    def of(self, table: Table) -> Array:
        """The values (n,) in the unit of the sweep's column. Raises SweepError."""
        values = self.term.of(table)
        if self.across is not None:
            return np.degrees(np.arctan2(values, self.across.of(table)))
        return values if self.unit is None else UNITS[self.unit].converted(values)

    @property
    def sources(self) -> tuple[str, ...]:
        """The columns of the log that it is made of."""
        return (self.term.source,) if self.across is None else (self.term.source, self.across.source)

    def __str__(self) -> str:
        if self.across is not None:
            return f"{self.target}=atan2({self.term}, {self.across})"
        return f"{self.target}={self.term}{'' if self.unit is None else f':{self.unit}'}"


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
    for needed in REQUIRED:
        if needed not in targets:
            raise UserError(f"--columns: {needed} is missing; say which column it is, e.g. {EXAMPLE!r}")
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
    pair = re.fullmatch(r"\s*atan2\s*\((.*)\)\s*", rest)
    if pair and QUANTITY.get(target) == "angle":
        terms = [_term(part, item)[0] for part in _items(pair[1])]
        if len(terms) != 2:
            raise UserError(f"--columns: {shown(item.strip())}: expected two channels, e.g. {target}=atan2(sin, cos)")
        return Column(target, terms[0], across=terms[1])
    term, more = _term(rest, item, whole=False)
    return Column(target, term, unit=_unit(more, target, item))


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


def _unit(text: str, target: str, item: str) -> str | None:
    """The unit behind a term; None where nothing stands there. Raises UserError."""
    if not text.strip():
        return None
    found = _UNIT.fullmatch(text)
    fitting = [name for name, unit in UNITS.items() if unit.quantity == QUANTITY.get(target)]
    if not found or found[1] not in fitting:
        units = f"one of {', '.join(fitting)} behind a colon" if fitting else f"none, as {target} has no unit"
        raise UserError(f"--columns: {shown(item.strip(), 80)}: found {shown(text.strip())} as unit; expected {units}")
    return found[1]
