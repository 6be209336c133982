"""Reading a log: its table, and the columns of a sweep by a given statement or by the one that is guessed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from twin.angles import Array
from twin.bounded_input import LARGEST_SWEEP_BYTES, checked_bytes, whole
from twin.errors import SweepError, UserError
from twin.log import LOG
from twin.logs.arrays import read_arrays
from twin.logs.buses import read_bus_text
from twin.logs.formats import read_format
from twin.logs.guess import Guess, guessed, unused_by
from twin.logs.statement import Column, parsed, values_of
from twin.logs.table import Table
from twin.logs.text import decoded, read_rows

EXPECTED = "a log (CSV, XLSX, MAT, NPZ, HDF5, Parquet, MDF, TDMS, a bus log or a firmware's table)"


@dataclass(frozen=True, eq=False)
class Log:
    """A log as columns (n,) of a sweep, the statement that makes them, and how the file was read."""

    columns: Mapping[str, Array]
    guess: Guess
    table: Table


def read_table(path: Path, *, max_bytes: int = LARGEST_SWEEP_BYTES) -> Table:
    """The table in a log, whatever its format. Raises SweepError."""
    try:
        raw = whole(path, most=checked_bytes(max_bytes), expected=EXPECTED)
    except UserError as error:
        raise SweepError(str(error)) from None
    found = read_format(raw, path, most=max_bytes)
    if found is not None:
        return found
    text, encoding = decoded(raw, path.name)
    found = read_bus_text(text, path) or read_arrays(text, file=path.name)
    return read_rows(text, encoding, file=path.name) if found is None else found


def read_log(path: Path, *, columns: str | None = None, max_bytes: int = LARGEST_SWEEP_BYTES) -> Log:
    """A log by the statement ``columns``, see :mod:`twin.logs.statement`; None: by the one that fits it.

    Raises UserError where it cannot be read, where nothing fits, and where two statements do.
    """
    stated = None if columns is None else parsed(columns)
    table = read_table(path, max_bytes=max_bytes)
    guess = guessed(table) if stated is None else by_statement(stated, table)
    if stated is not None:
        LOG.info("read %s: %s; not used: %s", table.file, guess.text, ", ".join((*guess.unused, *table.left)) or "none")
    return Log(values_of(guess.columns, table), guess, table)


def by_statement(columns: tuple[Column, ...], table: Table) -> Guess:
    """What is said, with the columns that it leaves out."""
    return Guess(columns, unused=unused_by(columns, table))
