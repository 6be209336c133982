"""What every kind of table has in common: how it is fitted, written, read back, and what a drive makes of it."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from diagnosis.correction.compensation_c import check_prefix
from diagnosis.correction.straight_lines import Least
from diagnosis.correction.wanted import Wanted
from twin.angles import Array, wrap

_WIDTH = 110


class Table(Protocol):
    """The entries of one table."""

    def __len__(self) -> int:
        """Number of entries."""

    def corrected(self, reading_rad: Array) -> Array:
        """The angle [rad] that the drive makes of readings (n,) [rad], by its own arithmetic."""

    def text(self, about: Sequence[str], name: str) -> str:
        """The file, with lines that say where it comes from as a comment."""


@dataclass(frozen=True)
class Target:
    """One kind of table.

    Attributes
    ----------
    name, what : str
        As it is asked for; which firmware reads it, in words.
    ending : str
        Of its files.
    axis, sign, unit : str
        Where the entries stand, what is done with them, what they count in: in words.
    entries, fewest, most, step : int
        Number of entries where none is asked for, the limits, and what it must be a multiple of.
    fitted : callable
        The best table of so many entries.
    read : callable
        The table of a file's text.
    absolute : bool
        Whether the drive's angle is the shaft's as the reference counts it; else it is the reading, corrected, with
        the sensor's own sense and zero.
    load : str
        What to do with the file.
    check_name : callable
        Refuses a name that cannot stand in the file.
    formula : str
        The shaft angle by what the file holds, where it does not hold all: with ``{reading}`` and ``{zero}`` in it.
    """

    name: str
    what: str
    ending: str
    axis: str
    sign: str
    unit: str
    entries: int
    fitted: Callable[[Wanted, int, Least], Table]
    read: Callable[[str], Table]
    load: str
    formula: str = ""
    fewest: int = 4
    most: int = 4096
    step: int = 1
    absolute: bool = False
    check_name: Callable[[str], None] = check_prefix

    def formula_of(self, wanted: Wanted) -> str:
        """The shaft angle by what the file holds; empty where the file holds all."""
        zero = np.degrees(-wanted.zero_rad)
        sense = "reading" if wanted.slope > 0 else "-reading"
        return self.formula.format(reading=sense, zero=f"{'-' if zero < 0 else '+'} {abs(zero):.6f}")

    @property
    def sizes(self) -> range:
        """The numbers of entries that there are."""
        return range(self.fewest, self.most + 1, self.step)

    def stored(self, wanted: Wanted, entries: int, least: Least) -> Table:
        """The best table, as it is read back from its file."""
        return self.read(self.fitted(wanted, entries, least).text((), "halltwin"))

    def shaft(self, table: Table, wanted: Wanted, reading_rad: Array) -> Array:
        """The shaft angle [rad] that follows from what the drive makes of readings [rad]."""
        corrected = table.corrected(reading_rad)
        return wrap(corrected) if self.absolute else wanted.from_added(corrected)


def c_comment(about: Sequence[str]) -> str:
    """Lines as a comment of C; nothing where there are none."""
    lines = _wrapped(about)
    return "/* " + "\n * ".join(line.replace("*/", "* /") for line in lines) + "\n */\n" if lines else ""


def hash_comment(about: Sequence[str]) -> str:
    """Lines as a comment of a configuration file."""
    return "".join(f"# {line}\n" for line in _wrapped(about))


def _wrapped(about: Sequence[str]) -> list[str]:
    """Lines of a comment, each no longer than a screen is wide; what a line goes on with is indented."""
    return [line for text in about for line in textwrap.wrap(text, _WIDTH, subsequent_indent="  ")]


def rows(values: Sequence[str], width: int) -> str:
    """Values with commas between, so many a line."""
    parts = [", ".join(values[k : k + width]) for k in range(0, len(values), width)]
    return ",\n    ".join(parts)


def numbers_of(text: str, name: str) -> Array:
    """The numbers between the braces of the C array whose name is this, or ends so behind an underscore."""
    found = re.search(rf"^(?:\w.*[ _])?{name}\[\d+\] = \{{([^}}]*)\}}", text, re.MULTILINE)
    if found is None:
        raise ValueError(f"no array {name}")
    return np.array([float(word.rstrip("f")) for word in found[1].replace(",", " ").split()])


def constant_of(text: str, name: str) -> int:
    """The whole number that the macro stands for whose name ends so behind an underscore."""
    found = re.search(rf"^#define \w+_{name} \(?(-?\d+)", text, re.MULTILINE)
    if found is None:
        raise ValueError(f"no constant {name}")
    return int(found[1])
