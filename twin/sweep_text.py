"""A sweep as text: CSV with units in the column names; comma, semicolon or tab; UTF-8, UTF-16 or Latin-1.

Lines are taken in blocks, so that beside the columns themselves no more than a block of the file is held.
"""

from __future__ import annotations

import codecs
import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.errors import ColumnMissing, SweepError
from twin.sweep_columns import COLUMNS, TOLD_BY_SENSOR, lacking
from twin.text_input import MISSING, cells_of, no_text, utf8_or_latin1

LONGEST_LINE_BYTES = 1_000_000
"""A line that is longer belongs to no sweep: a row of all columns takes some two hundred bytes."""
_WIDE = (b"\xff\xfe", b"\xfe\xff")


@dataclass(frozen=True)
class _Header:
    """What the header line says: its number, how cells are parted, all names, and which are known."""

    line: int
    delimiter: str
    names: tuple[str, ...]

    @property
    def wanted(self) -> dict[str, int]:
        """Place of each known column."""
        return {cell: place for place, cell in enumerate(self.names) if cell in COLUMNS}


class _Growing:
    """A column that grows in place, so that its cells are never held twice."""

    def __init__(self) -> None:
        self._cells: Array = np.empty(0)
        self._count = 0

    def add(self, values: Array) -> None:
        """Put cells (n,) behind those that are there."""
        end = self._count + values.size
        if end > self._cells.size:
            self._cells.resize(max(end, self._cells.size + self._cells.size // 8), refcheck=False)
        self._cells[self._count : end] = values
        self._count = end

    def told(self) -> Array:
        """The column (n,), which grows no more."""
        self._cells.resize(self._count, refcheck=False)
        return self._cells


def parse_csv(content: Iterable[bytes], *, name: str, spin: bool = False) -> dict[str, Array]:
    """The known columns (n,) of a CSV file, handed over in blocks of bytes; lines that begin with # are comments.

    ``spin``: those of a log without a reference will do. Raises SweepError.
    """
    header: _Header | None = None
    columns: dict[str, _Growing] = {}
    first = 1
    for text in _whole_lines(content, name=name):
        # Not splitlines(): it also breaks at characters that editors do not count as the end of a line.
        lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        told = [k for k, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")]
        if header is None and told:
            header = _header_of(lines[told[0]], first + told[0], name=name, spin=spin)
            told = told[1:]
        if header is not None and told:
            table = _table(lines, told, header, where=(name, first))
            for place, cell in enumerate(header.wanted):
                columns.setdefault(cell, _Growing()).add(table[:, place])
        first += len(lines) - 1
    if header is None:
        raise SweepError(f"{name}: the file is empty; expected a header line and one row per reading")
    if not columns:
        raise SweepError(f"{name}: no row below the header of line {header.line}; expected one row per reading")
    return {cell: columns[cell].told() for cell in header.wanted}


def _whole_lines(content: Iterable[bytes], *, name: str) -> Iterator[str]:
    """Blocks of text that end where a line ends. Raises SweepError for what is no text."""
    before, pending = 0, b""
    for block in _narrow(content):
        pending += block
        # A carriage return at the very end may be half of a line's end.
        cut = max(pending.rfind(b"\n"), pending.rfind(b"\r", 0, -1)) + 1
        if cut:
            text = _decoded(pending[:cut], before, name=name)
            before += text.count("\n")
            pending = pending[cut:]
            yield text
        if len(pending) > LONGEST_LINE_BYTES:
            _refuse_binary(pending.decode("latin-1"), before, name=name)
            raise SweepError(
                f"{name}: line {before + 1} is longer than {LONGEST_LINE_BYTES:,} bytes; "
                "expected one row per reading, with the columns of a sweep"
            )
    if pending:
        yield _decoded(pending, before, name=name)


def _narrow(content: Iterable[bytes]) -> Iterator[bytes]:
    """The blocks without a byte order mark; those of UTF-16 as UTF-8, in which a line's end is a byte of its own."""
    rest = iter(content)
    first = b""
    while len(first) < len(codecs.BOM_UTF8) and (block := next(rest, b"")):
        first += block
    if first[:2] not in _WIDE:
        yield first.removeprefix(codecs.BOM_UTF8)
        yield from rest
        return
    decoder = codecs.getincrementaldecoder("utf-16")("replace")
    for block in itertools.chain((first,), rest):
        yield decoder.decode(block).encode("utf-8", "replace")


def _decoded(raw: bytes, before: int, *, name: str) -> str:
    """Whole lines as text."""
    text, _ = utf8_or_latin1(raw)
    _refuse_binary(text, before, name=name)
    return text


def _refuse_binary(text: str, before: int, *, name: str) -> None:
    """Raise SweepError for bytes that no text holds; ``before`` lines stand before this text."""
    said = no_text(text, before)
    if said:
        raise SweepError(f"{name}: {said}; expected CSV: export the sweep as text")


def _header_of(text: str, line: int, *, name: str, spin: bool) -> _Header:
    delimiter = ";" if ";" in text else "\t" if "\t" in text else ","
    names = tuple(cell.strip() for cell in cells_of(text, delimiter))
    _check_header(names, where=f"{name}: line {line}", spin=spin)
    return _Header(line, delimiter, names)


def _check_header(header: tuple[str, ...], *, where: str, spin: bool) -> None:
    found = _shown(",".join(header), 200)
    if all(_is_number(cell) for cell in header):
        raise SweepError(
            f"{where} holds {found} where the header is expected; "
            "put the column names above the numbers, e.g. reference_deg,measured_deg"
        )
    for cell in COLUMNS:
        if header.count(cell) > 1:
            raise SweepError(f"{where}: column {cell} stands {header.count(cell)} times; expected it once: keep one")
    missing = lacking(header, spin=spin)
    if missing:
        raise ColumnMissing(f"{where}: {missing}; found {found}; rename the column or add it")


def _shown(text: str, most: int = 40) -> str:
    """Text of a file as it may stand in a message."""
    return repr(text if len(text) <= most else text[:most] + "...")


def _table(lines: list[str], told: list[int], header: _Header, *, where: tuple[str, int]) -> Array:
    """The known columns (rows, columns) of some lines; ``where``: name of the file, number of the first line."""
    table = _fast_table([lines[k] for k in told], header)
    if table is None:
        name, first = where
        table = _careful_table([(first + k, lines[k]) for k in told], header, name=name)
    return table[:, list(header.wanted.values())]


def _fast_table(rows: list[str], header: _Header) -> Array | None:
    """All cells at once where every one is a number; None where one is not, or a row is ragged."""
    try:
        table = np.loadtxt(rows, delimiter=header.delimiter, ndmin=2, comments=None, dtype=np.float64)
    except ValueError:
        return None
    return table if table.shape[1] == len(header.names) else None


def _careful_table(rows: list[tuple[int, str]], header: _Header, *, name: str) -> Array:
    """Cell by cell, so that the first fault is named by line and column."""
    table = np.full((len(rows), len(header.names)), np.nan)
    for row, (number, line) in enumerate(rows):
        cells = cells_of(line, header.delimiter)
        if len(cells) != len(header.names):
            raise SweepError(
                f"{name}: line {number} has {len(cells)} cells; expected {len(header.names)} as in the header "
                f"({_shown(','.join(header.names), 200)}); leave a cell empty where a reading is missing"
            )
        for key, place in header.wanted.items():
            text = cells[place].strip()
            if text.lower() in MISSING:
                continue
            # Where cells are not parted by commas, a comma is a decimal point.
            value = _number(text if header.delimiter == "," else text.replace(",", "."))
            if value is None and key in TOLD_BY_SENSOR:
                # Status words may be words: they tell of a reading, and are none.
                continue
            if value is None:
                raise SweepError(
                    f"{name}: line {number}, column {key}: {_shown(text)} is not a number; "
                    "leave the cell empty where a reading is missing"
                )
            table[row, place] = value
    return table


def _number(text: str) -> float | None:
    try:
        # Python reads 1_000 as a thousand; nobody who wrote a sweep meant that.
        return None if "_" in text else float(text)
    except ValueError:
        return None


def _is_number(text: str) -> bool:
    return text.strip().lower() in MISSING or _number(text.strip().replace(",", ".")) is not None
