"""A log as text: any separator, decimal point or comma, encoding, and whatever stands above the numbers."""

from __future__ import annotations

import codecs
import math
import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from twin.errors import SweepError
from twin.logs.cells import Row, is_number, number_of, table_of
from twin.logs.labelled import without_labels
from twin.logs.table import INDEX, Table
from twin.shown import shown
from twin.text_input import cells_of, no_text, utf8_or_latin1

_SEPARATORS = {";": "semicolons", "\t": "tabs", ",": "commas", "|": "bars", "": "blanks"}
"""What may part cells, with the word for it; an empty one stands for any run of blanks."""
_COMMENTS = ("#", "%", "//")
_JUDGED_LINES = 400
"""Lines at the end of a file that its separator is told by: far from what may stand above the numbers."""
_FEW_ROWS, _WIDE_ROW = 4, 16
"""So few rows of so many cells are no log, but the entries of a table."""
_WIDE_SHARE = 0.4
"""Share of zero bytes in every other place from which a text without a mark is UTF-16."""


def read_rows(text: str, encoding: str, *, file: str) -> Table:
    """The table in a text, a row a line. Raises SweepError where there is none."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    numbered = [(k, line.strip("\ufeff\0 ").rstrip()) for k, line in enumerate(lines, start=1)]
    told = [(k, line) for k, line in numbered if line.strip()]
    plain = [(k, line) for k, line in told if not line.lstrip().startswith(_COMMENTS)]
    if not plain:
        raise SweepError(f"{file}: the file is empty; expected a header line and one row per reading")
    labelled = without_labels(plain)
    plain = labelled or plain
    separator = _separator([line for _, line in plain[-_JUDGED_LINES:]])
    if separator is None:
        single = _one_a_line(plain, file=file, notes=(encoding, "one number in each line"))
        if single is not None:
            return single
        raise SweepError(
            f"{file}: line {plain[-1][0]} holds {shown(plain[-1][1])}; expected two or more numbers in each line, "
            "parted by commas, semicolons, tabs or blanks: export the log as CSV"
        )
    rows = [Row(k, tuple(_cells(line, separator))) for k, line in plain]
    remarks = [
        Row(k, tuple(_cells(line.lstrip("#%/ \t"), separator)))
        for k, line in told
        if line.lstrip().startswith(_COMMENTS)
    ]
    rows, empty = _without_empty_ends(rows)
    parted = "each number behind its name" if labelled else f"cells parted by {_SEPARATORS[separator]}"
    notes = (encoding, parted, *(f"column {shown(name)} is empty" for name in empty))
    if len(rows) <= _FEW_ROWS and len(rows[-1].cells) >= _WIDE_ROW:
        listed = _entries([cell for row in rows for cell in row.cells], "entry", file=file, notes=notes)
        if listed is not None:
            return listed
    return table_of(rows, remarks, file=file, comma_parts=separator == ",", notes=notes)


def _one_a_line(lines: Sequence[tuple[int, str]], *, file: str, notes: tuple[str, ...]) -> Table | None:
    """One number in each line, with or without a name above them, as a table's entries; None for anything else."""
    cells = [line.strip().rstrip(",;").strip() for _, line in lines]
    named = not is_number(cells[0], comma_parts=False)
    return _entries(cells[named:], cells[0] if named else "entry", file=file, notes=notes)


def _entries(cells: Sequence[str], name: str, *, file: str, notes: tuple[str, ...]) -> Table | None:
    """Numbers as the entries of a table; None where one is no number, or they are few."""
    values = [number_of(cell, comma_parts=False) for cell in cells]
    if len(values) < _WIDE_ROW or any(value is None or math.isnan(value) for value in values):
        return None
    entries = np.array(values, dtype=np.float64)
    return Table(file, (INDEX, name), (np.arange(entries.size, dtype=np.float64), entries), notes=notes, entries=True)


def decoded(raw: bytes, file: str) -> tuple[str, str]:
    """The text and the name of its encoding. Raises SweepError for what is no text."""
    encoding = "UTF-8"
    wide = next((bom for bom in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE) if raw.startswith(bom)), None)
    head = raw[:2000]
    if wide:
        encoding = "UTF-16"
    elif head[1::2].count(0) > _WIDE_SHARE * len(head[1::2]) and not head[::2].count(0):
        encoding = "UTF-16-LE"
    elif head[::2].count(0) > _WIDE_SHARE * len(head[::2]) and not head[1::2].count(0):
        encoding = "UTF-16-BE"
    if encoding == "UTF-8":
        text, encoding = utf8_or_latin1(raw.removeprefix(codecs.BOM_UTF8))
    else:
        text = raw.decode(encoding, "replace")
    said = no_text(text)
    if said:
        raise SweepError(
            f"{file}: {said}; expected CSV, XLSX, MAT, NPZ, HDF5, Parquet, MDF or TDMS: export the log as one of them"
        )
    return text, encoding


def _separator(lines: Sequence[str]) -> str | None:
    """What parts the most lines into equally many cells, two of them numbers or more; None where nothing does."""
    best, most = None, 0
    for separator in _SEPARATORS:
        widths: Counter[int] = Counter()
        for line in lines:
            cells = _cells(line, separator)
            if sum(is_number(cell, comma_parts=separator == ",") for cell in cells) >= 2:
                widths[len(cells)] += 1
        count = max(widths.values(), default=0)
        if count > most:
            best, most = separator, count
    return best


def _cells(line: str, separator: str) -> list[str]:
    """The cells of a line without blanks and quotes; the unit in brackets stays with its name."""
    if not separator:
        return _by_blanks(line) if "[" in line or "(" in line else line.split()
    return [cell.strip() for cell in cells_of(line, separator)]


def _by_blanks(line: str) -> list[str]:
    """Cells parted by blanks, a unit in brackets taken as part of the name before it."""
    joined = re.sub(r"\s+([\[(][^\])]*[\])])", lambda found: "\0" + found[1].replace(" ", "\0"), line.strip())
    return [cell.replace("\0", " ") for cell in joined.split()]


def _without_empty_ends(rows: list[Row]) -> tuple[list[Row], list[str]]:
    """The rows without their last cell where it is empty in all that have as many: lines that end with a separator.

    Where it has a name it is a column that nobody filled in, and the name is given back.
    """
    width = Counter(len(row.cells) for row in rows).most_common(1)[0][0]
    full = [row for row in rows if len(row.cells) == width]
    if width < 3 or any(row.cells[-1] for row in full if is_number(row.cells[0], comma_parts=False)):
        return rows, []
    names = [row.cells[-1] for row in full if row.cells[-1]]
    return [Row(row.number, row.cells[:-1]) if len(row.cells) == width else row for row in rows], names
