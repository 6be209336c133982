"""The record in a log: by a statement, by the one that is guessed, or, where none fits, by the names alone."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.missing_reference import hardly_a_reference
from diagnosis.setup.ratio import POLE_PAIRS, pole_pairs
from diagnosis.setup.record import FEWEST, Record
from twin.angles import Array
from twin.bounded_input import LARGEST_SWEEP_BYTES
from twin.errors import SweepError
from twin.logs.angles import COUNTS_PER_TURN
from twin.logs.asked_back import OpenGuess
from twin.logs.guess import Guess, guessed, unused_by
from twin.logs.names import Meaning, meaning_of
from twin.logs.others import others
from twin.logs.read import by_statement, read_table
from twin.logs.statement import Column, Term, parsed, values_of
from twin.logs.table import Table
from twin.periods import of_the_shaft
from twin.sweep_columns import COLUMNS

_OF_PERIODS = frozenset({"reference_deg", "measured_deg", "vx", "vy"})
"""Columns that may turn several times in a turn of the shaft."""
_FEWEST_BITS = 12
"""Of a word whose values show no turn: shorter ones hardly leave a sensor any more."""


@dataclass(frozen=True, eq=False)
class LogRecord:
    """The record in a log.

    Attributes
    ----------
    record : Record
        Its columns.
    read_as : str
        The statement for ``--columns`` that reads them so.
    read, notes, unused : tuple of str
        How the file was read; what was taken for granted; the columns that are not used.
    refused : str
        Why no statement was found that makes a sweep of it, in the reader's words; empty where one was.
    findings : tuple of Finding
        What the guess has mended already: an angle that turns several times as fast.
    otherwise : tuple of LogRecord
        The log read by other statements, where several fit equally well: none of them is the one that is meant.
    """

    record: Record
    read_as: str
    read: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()
    refused: str = ""
    findings: tuple[Finding, ...] = ()
    otherwise: tuple[LogRecord, ...] = ()


def read_record(
    path: Path, *, name: str, columns: str | None = None, max_bytes: int = LARGEST_SWEEP_BYTES
) -> LogRecord:
    """The record in a log.

    Parameters
    ----------
    path : Path
        A log of any kind that ``halltwin import`` reads.
    name : str
        What messages call it.
    columns : str or None
        Which of its columns are those of a sweep; None: they are guessed.
    max_bytes : int
        Most bytes of it.

    Raises
    ------
    twin.errors.UserError
        Where it holds no table of numbers, or the statement does not fit it.
    """
    stated = None if columns is None else parsed(columns)
    table = read_table(path, max_bytes=max_bytes)
    if stated is not None:
        return _of(table, by_statement(stated, table), name=name)
    try:
        guess = guessed(table)
        found = _by_names(table, name=name, refused="") if _leaves_a_reference(guess, table) else None
        return _with_mended(_of(table, guess, name=name), table) if found is None else found
    except OpenGuess as two:
        if two.example:
            raise
        if two.alone:
            guess = Guess(two.alone, unused=unused_by(two.alone, table))
            found = _of(table, guess, name=name, refused=str(two))
            return replace(found, findings=(hardly_a_reference(two.what, found.record, option=two.options[0]),))
        if two.fit:
            return _of_several(table, two, name=name)
        found = _by_names(table, name=name, refused=str(two))
        return found if found is not None else _of_options(table, two, name=name)
    except SweepError as error:
        found = _by_names(table, name=name, refused=str(error))
        if found is None:
            raise
        return found


def with_pole_pairs(read: LogRecord, known: int) -> LogRecord:
    """The record of a sensor that is known to have so many periods a turn: that it turns so often is no fault.

    An angle that turns as often becomes that of the shaft; one that turns otherwise is left as it is.
    """
    record, findings = read.record, read.findings
    if any(column.per == known for column in record.statement):
        findings = tuple(finding for finding in findings if finding.kind != POLE_PAIRS)
    if known > 1 and record.both.size >= FEWEST:
        columns = {name: values.copy() for name, values in record.columns.items()}
        with suppress(SweepError):
            made = of_the_shaft(
                {name: columns[name][record.both] for name in _OF_PERIODS & set(columns)}, known, name=""
            )
            for name in ("reference_deg", "measured_deg"):
                columns[name][record.both] = made[name]
            columns = {name: values for name, values in columns.items() if name in made or name not in _OF_PERIODS}
        record = replace(record, columns=columns)
    rest = tuple(with_pole_pairs(one, known) for one in read.otherwise)
    return replace(read, record=record, findings=findings, otherwise=rest)


def _with_mended(read: LogRecord, table: Table) -> LogRecord:
    """With what the guess has mended as a finding: whoever recorded an electrical angle wants to know."""
    columns = tuple(replace(column, per=None) for column in read.record.statement)
    if columns == read.record.statement:
        return read
    found = pole_pairs(replace(read.record, columns=dict(values_of(columns, table)), statement=columns))
    return read if found is None else replace(read, findings=(replace(found, columns=read.read_as),))


def _leaves_a_reference(guess: Guess, table: Table) -> bool:
    """Whether a sensor's angle is held against its own channels, and a column named as the reference is left out."""
    if not any(column.across is not None for column in guess.columns):
        return False
    used = {table.place(source) for one in guess.columns for source in one.sources}
    said = [meaning_of(name) for k, name in enumerate(table.names) if k not in used]
    return any(one.role == "angle" and one.reference > one.sensor for one in said)


def _of(table: Table, guess: Guess, *, name: str, refused: str = "") -> LogRecord:
    values = dict(values_of(guess.columns, table))
    held = {key: column for key, column in values.items() if np.isfinite(column).any()}
    rows = next(iter(values.values())).size
    record = Record(name, held, np.arange(1, rows + 1), guess.columns)
    unused = (*guess.unused, *table.left)
    return LogRecord(record, guess.text, read=table.notes, notes=guess.notes, unused=unused, refused=refused)


def _of_options(table: Table, two: OpenGuess, *, name: str) -> LogRecord:
    """By the first of some statements of which one may be meant, against what the names say."""
    return _of(table, by_statement(parsed(two.options[0]), table), name=name, refused=str(two))


def _of_several(table: Table, two: OpenGuess, *, name: str) -> LogRecord:
    """By each of the statements that fit equally well; which one is meant is asked."""
    first, *rest = (
        _with_mended(_of(table, by_statement(parsed(option), table), name=name, refused=str(two)), table)
        for option in two.options
    )
    return replace(first, otherwise=tuple(rest))


def _by_names(table: Table, *, name: str, refused: str) -> LogRecord | None:
    """What the names say, whatever the values; None where they name no angle."""
    said = tuple(meaning_of(one) for one in table.described)
    usable = [k for k, column in enumerate(table.values) if k not in table.faults and np.isfinite(column).sum() >= 4]
    angles = [k for k in usable if said[k].role == "angle"]
    if not angles:
        return None
    measured = max(angles, key=lambda k: (said[k].sensor - said[k].reference, -k))
    rest = [k for k in angles if k != measured]
    reference = max(rest, key=lambda k: (said[k].reference - said[k].sensor, -k), default=None)
    if reference is None and said[measured].reference:
        return None
    chosen = [(("measured_deg"), measured)] + ([] if reference is None else [("reference_deg", reference)])
    columns = [_angle(target, table.sources[k], table.values[k], said[k]) for target, k in chosen]
    path = columns[-1].of(table)
    beside = others(table, said, usable, path)
    every = sorted((*columns, *_own_channels(table, said, usable), *beside.columns), key=_order)
    unused = unused_by(tuple(every), table, beside.why)
    return _of(table, Guess(tuple(every), beside.notes, unused), name=name, refused=refused)


def _order(column: Column) -> int:
    return COLUMNS.index(column.target)


def _own_channels(table: Table, said: tuple[Meaning, ...], usable: list[int]) -> list[Column]:
    cos, sin = ([k for k in usable if said[k].role == role] for role in ("cos", "sin"))
    if len(cos) != 1 or len(sin) != 1:
        return []
    return [Column("vx", Term(table.sources[cos[0]])), Column("vy", Term(table.sources[sin[0]]))]


def _angle(target: str, source: str, values: Array, said: Meaning) -> Column:
    """An angle in the unit of its name, else in the one whose turn its values fill, else in degrees."""
    if said.unit is not None:
        return Column(target, Term(source), None if said.unit.name == "deg" else said.unit.name)
    known = values[np.isfinite(values)]
    span = float(np.ptp(known))
    if (said.counts or span > 370.0) and bool(np.all(known % 1.0 == 0.0)):
        wraps = bool(np.any(np.abs(np.diff(known)) > 0.5 * span))
        full = [many for many in COUNTS_PER_TURN if wraps and 0.98 * many <= span <= many]
        counts = float(full[0]) if full else 2.0 ** max(int(np.ceil(np.log2(span + 1.0))), _FEWEST_BITS)
        return Column(target, Term(source, (("*", 360.0), ("/", counts))))
    return Column(target, Term(source), "rad" if span <= 6.3 and np.any(known % 1.0 != 0.0) else None)
