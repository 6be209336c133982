"""Rows of cells as a table: where the numbers begin, which row names them, which cells are no numbers."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from twin.errors import SweepError
from twin.logs.remarks import units_remarked
from twin.logs.table import Table
from twin.logs.units import COUNTS, unit_of
from twin.shown import shown
from twin.text_input import MISSING

_MISSING = MISSING | {"#n/a", "--"}
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?")
_HEX = re.compile(r"0[xX][0-9a-fA-F]{1,13}")
_HEADER_ROWS = 2
_WORDS_SHARE = 0.5
"""Share of cells that are no numbers from which a column holds words, and no number is mistyped."""


class Row(NamedTuple):
    """A row of a file by its number, the first being 1, and its cells."""

    number: int
    cells: tuple[str, ...]


def number_of(cell: str, *, comma_parts: bool) -> float | None:
    """The number in a cell, NaN where it is missing, None where it is none; a comma that parts no cells is a point."""
    text = cell if comma_parts or "." in cell else cell.replace(",", ".")
    if _NUMBER.fullmatch(text):
        return float(text.replace("d", "e").replace("D", "e"))
    if _HEX.fullmatch(text):
        return float(int(text, 16))
    return math.nan if cell.lower() in _MISSING else None


def is_number(cell: str, *, comma_parts: bool) -> bool:
    """Whether a cell holds a number, and not nothing."""
    value = number_of(cell, comma_parts=comma_parts)
    return value is not None and not math.isnan(value)


def table_of(
    rows: Sequence[Row], remarks: Sequence[Row], *, file: str, comma_parts: bool, notes: tuple[str, ...] = ()
) -> Table:
    """The table in rows of cells; ``remarks`` are the commented ones, of which one may hold the names.

    Raises SweepError where there is none, or a row has not as many cells as the others.
    """
    numbers = [sum(is_number(cell, comma_parts=comma_parts) for cell in row.cells) for row in rows]
    widths = Counter(len(row.cells) for row, count in zip(rows, numbers, strict=True) if count >= 2)
    if not widths:
        raise SweepError(f"{file}: no row holds two numbers; expected a header line and one row per reading")
    width = widths.most_common(1)[0][0]
    first = next(k for k, row in enumerate(rows) if numbers[k] >= 2 and len(row.cells) == width)
    behind = [k for k in range(first + 1, min(first + 1 + _HEADER_ROWS, len(rows))) if len(rows[k].cells) == width]
    # Names may be numbers, as those of a scope's channels, where the row of their units stands below them.
    if words := [k for k in behind if all(map(_is_unit, rows[k].cells)) and any(rows[k].cells)]:
        first = words[-1] + 1
    if first >= len(rows):
        raise SweepError(f"{file}: no numbers stand below the header of line {rows[-1].number}; expected readings")
    data = rows[first:]
    for row in data:
        if len(row.cells) != width:
            raise SweepError(
                f"{file}: line {row.number} has {len(row.cells)} cells ({shown(','.join(row.cells), 80)}); expected "
                f"{width} as in the others; leave a cell empty where a reading is missing, and take out what is no row"
            )
    names, said = _names(rows[:first], remarks, width, file=file, data=data)
    columns = [_column([(row.number, row.cells[k]) for row in data], comma_parts=comma_parts) for k in range(width)]
    called = [name or f"#{k + 1}" for k, name in enumerate(names)]
    faults = {k: fault.replace("\0", called[k]) for k, (_, fault) in enumerate(columns) if fault}
    remarked = units_remarked(names, [" ".join(row.cells) for row in remarks if row.number < data[0].number])
    units = ", ".join(f"{called[k]} in {unit}" for k, unit in remarked.items())
    said = (*said, f"by a comment {units}") if units else said
    return Table(file, names, tuple(values for values, _ in columns), faults, (*notes, *said), remarked=remarked)


def _names(
    above: Sequence[Row], remarks: Sequence[Row], width: int, *, file: str, data: Sequence[Row]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The names of the columns, empty where there is no header, and what is to be said of it. Raises SweepError."""
    begin = data[0].number
    plain = [row for row in above if len(row.cells) == width]
    near = [row for row in remarks if row.number < begin and len(row.cells) == width]
    if plain and plain[-1] is above[-1]:
        header = plain[-1]
        cells = header.cells
        if len(plain) > 1 and all(_is_unit(cell) for cell in cells):
            header = plain[-2]
            cells = tuple(
                f"{name} [{unit.strip('[]() ')}]" if unit.strip("[]() -") else name
                for name, unit in zip(header.cells, cells, strict=True)
            )
        skipped = above.index(header)
        more = (f"{skipped} lines above the header of line {header.number} are not used",) if skipped else ()
        return cells, more
    if above:
        row = above[-1]
        count = len(row.cells)
        if width == 2 * count and all(re.fullmatch(r"[+-]?\d+", cell) for cell in data[0].cells):
            raise SweepError(
                f"{file}: line {begin} has {width} cells under {count} names: commas stand between cells and in "
                "numbers; expected decimal points, or semicolons between cells: export it so"
            )
        if count > 1 or width == 1:
            raise SweepError(
                f"{file}: line {row.number} has {count} cells ({shown(','.join(row.cells), 80)}) above rows "
                f"of {width}; expected a name for each column: mend the header, or comment it out with # and give "
                '--columns "reference_deg=#1, measured_deg=#2"'
            )
    if near and not any(is_number(cell, comma_parts=True) for cell in near[-1].cells):
        return near[-1].cells, (f"names from the comment of line {near[-1].number}",)
    unread = f"; the {len(above)} lines above the numbers are not used" if above else ""
    return ("",) * width, (f"no header: columns go by their places{unread}",)


def _is_unit(cell: str) -> bool:
    word = cell.strip("[]() ").lower()
    return word in ("", "-", "v", "mv", "volt", "volts", "a", "mt") or unit_of(word) is not None or word in COUNTS


def _column(cells: Sequence[tuple[int, str]], *, comma_parts: bool) -> tuple[np.ndarray, str]:
    """Numbers (n,) of one column, and what is wrong with it: the first cell that is none, or that it holds words."""
    try:
        # numpy reads 1_000 as a thousand; nobody who wrote a log meant that.
        if any("_" in text for _, text in cells):
            raise ValueError
        return np.array([text for _, text in cells], dtype=np.float64), ""
    except ValueError:
        pass
    values = np.full(len(cells), np.nan)
    wrong: list[tuple[int, str]] = []
    for k, (number, text) in enumerate(cells):
        value = number_of(text, comma_parts=comma_parts)
        if value is None:
            wrong.append((number, text))
        else:
            values[k] = value
    if not wrong:
        return values, ""
    number, text = wrong[0]
    if len(wrong) > _WORDS_SHARE * len(cells):
        return values, f"column \0 holds words such as {shown(text)}; expected numbers"
    return values, (
        f"line {number}, column \0: {shown(text)} is not a number; leave the cell empty where a reading is missing"
    )
