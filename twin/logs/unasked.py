"""A file that is no sweep as it stands: the log that it is by the one statement that fits, or why it is refused."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from twin.angles import Array
from twin.errors import ColumnMissing, SweepError
from twin.logs.asked_back import OpenGuess, in_words
from twin.logs.guess import guessed
from twin.logs.read import Log, read_table
from twin.logs.statement import Column, values_of
from twin.logs.table import Table
from twin.sweep_columns import REQUIRED, is_spin

_Checked = TypeVar("_Checked")
_NEEDS_REFERENCE = "here a reference is needed; explain, compensate and export take this log without one, by"
LARGEST_READ_TWICE = 5_000_000
"""Of a longer file that was refused for what it holds, nothing is guessed: reading it once took its time."""


@dataclass(frozen=True, eq=False)
class Unread:
    """A file that was refused as a sweep, and why.

    ``spin``: a log without a reference would do.
    """

    path: Path
    why: SweepError
    max_bytes: int
    spin: bool

    def log(self) -> Log:
        """What the file holds by the one statement that fits it.

        Raises SweepError: why it was refused, and which statements would read it, where any do.
        """
        table = self._table()
        said, advised = self._said(table)
        try:
            guess = guessed(table)
        except OpenGuess as several:
            raise SweepError(f"{advised} ({several.what}): {in_words(several.options)}") from None
        except SweepError as error:
            unread = str(error).removeprefix(f"{table.file}: ")
            raise SweepError(f"{said}; {unread}" if isinstance(self.why, ColumnMissing) else said) from None
        if all(str(column) == f"{column.target}={column.target}" for column in guess.columns):
            raise SweepError(said)
        if not self.spin and is_spin([column.target for column in guess.columns]):
            raise SweepError(f"{said}; {_NEEDS_REFERENCE}: {in_words([guess.text])}")
        return Log(values_of(guess.columns, table), guess, table)

    def checked(self, log: Log, check: Callable[[Mapping[str, Array]], _Checked], *, guess: bool) -> _Checked:
        """What ``check`` makes of the log. Raises SweepError: what it finds, or unless ``guess`` the statement to give.

        Of a file that bears a sweep's names, but for capitals, nothing is guessed: what its values say against them is
        the user's to decide.
        """
        option = in_words([log.guess.text])
        try:
            found = check(log.columns)
        except SweepError as error:
            raise SweepError(f"{error} (read as {option})") from None
        if guess and (_in_capitals(log.guess.columns) or not _bears_names_of_a_sweep(log.table)):
            return found
        raise SweepError(f"{self._said(log.table)[1]}: {option}")

    def _table(self) -> Table:
        """What the file holds. Raises SweepError where that is not looked at, or is no table."""
        missing = isinstance(self.why, ColumnMissing)
        if not self.path.is_file():
            piped = "; of a file, but not of a pipe, what else its columns may mean is told"
            raise SweepError(f"{self.why}{piped if missing else ''}")
        # That a column is missing was told by the first line.
        most = self.max_bytes if missing else LARGEST_READ_TWICE
        try:
            if self.path.stat().st_size <= most:
                return read_table(self.path, max_bytes=most)
        except (SweepError, OSError):
            pass
        raise SweepError(str(self.why))

    def _said(self, table: Table) -> tuple[str, str]:
        """Why the file is refused, alone and with the words that lead to a statement.

        Of a table of entries, as source text of a firmware holds it, there are no columns to speak of.
        """
        if table.entries and not _bears_names_of_a_sweep(table):
            said = f"{table.file}: holds a table of {len(table.values[0])} entries, and no columns of a sweep"
            return said, f"{said}; say what is meant"
        return str(self.why), f"{self.why}; or say what is meant"


def _bears_names_of_a_sweep(table: Table) -> bool:
    """Whether columns bear a sweep's names: then they are those of a sweep, whatever they lack."""
    return any(column in name for name in table.names for column in REQUIRED)


def _in_capitals(columns: tuple[Column, ...]) -> bool:
    """Whether these are a sweep's own names in large or small letters."""
    return all(str(column).lower() == f"{column.target}={column.target}" for column in columns)
