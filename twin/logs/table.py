"""A table of numbers as a log holds it, under its own names and in its own units."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from twin.angles import Array
from twin.errors import SweepError
from twin.shown import shown

LARGEST = 1e20
"""The largest number that a column of a bench may mean; nanoseconds since 1970 are 2e18."""
INDEX = "index"
"""Column that counts the rows, or the entries of a table."""


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of a log, each (n,), NaN where a cell is missing.

    ``names`` are those of the file, empty where it gives none. ``faults`` says for a column's place which cell is no
    number, ``notes`` how the file was read, ``left`` what it holds beside columns of numbers. ``entries``: the rows are
    the entries of a firmware's table, and the first column, ``index``, counts them from 0; ``constants`` are the single
    numbers beside it, by their names. ``remarked`` holds by a column's place the unit that stands in a comment alone.
    """

    file: str
    names: tuple[str, ...]
    values: tuple[Array, ...]
    faults: Mapping[int, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    left: tuple[str, ...] = ()
    entries: bool = False
    constants: Mapping[str, float] = field(default_factory=dict)
    remarked: Mapping[int, str] = field(default_factory=dict)

    @property
    def described(self) -> tuple[str, ...]:
        """The names, each with the unit that a comment gives it."""
        return tuple(
            f"{name} [{self.remarked[k]}]" if k in self.remarked else name for k, name in enumerate(self.names)
        )

    @property
    def sources(self) -> tuple[str, ...]:
        """What each column is called by: its name, or its place (``#3``) where the name is missing or not its own."""
        return tuple(
            name if name and self.names.count(name) == 1 and not re.fullmatch(r"#\d+", name) else f"#{k + 1}"
            for k, name in enumerate(self.names)
        )

    def place(self, source: str) -> int:
        """Place of a column by its name or ``#3``. Raises SweepError."""
        by_place = re.fullmatch(r"#(\d{1,6})", source)
        if by_place and 1 <= int(by_place[1]) <= len(self.names):
            return int(by_place[1]) - 1
        found = [k for k, name in enumerate(self.names) if name == source]
        if len(found) > 1:
            places = " or ".join(f"#{k + 1}" for k in found)
            raise SweepError(f"{self.file}: column {shown(source)} stands {len(found)} times; say which: {places}")
        if not found:
            raise SweepError(f"{self.file}: no column {shown(source)}; found {self.listed()}")
        return found[0]

    def counts_rows(self, source: str) -> bool:
        """Whether the rows are meant, counted from 0: a column ``index`` where there is none of that name."""
        return source == INDEX and INDEX not in self.names and bool(self.values)

    def values_of(self, source: str) -> Array:
        """The values (n,) of a column. Raises SweepError where it is not there, or a cell is no number."""
        if self.counts_rows(source):
            return np.arange(self.values[0].size, dtype=np.float64)
        place = self.place(source)
        if place in self.faults:
            raise SweepError(f"{self.file}: {self.faults[place]}")
        return self.values[place]

    def listed(self, most: int = 300) -> str:
        """The columns as a message names them."""
        text = ", ".join(shown(name, 60) if name else f"#{k + 1}" for k, name in enumerate(self.names)) or "none"
        return text if len(text) <= most else text[:most] + "..."
