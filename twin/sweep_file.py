"""Sweep files: CSV with units in the column names, comma or semicolon, plain or gzip; Parquet where pyarrow is."""

from __future__ import annotations

import csv
import gzip
import io
import re
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from twin.angles import Array
from twin.errors import SweepError
from twin.sweep_columns import COLUMNS, REQUIRED
from twin.whole_file import write_beside

_BYTE_ORDER_MARKS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
_MISSING = frozenset({"", "nan", "na", "n/a", "null", "none", "-", "inf", "+inf", "-inf", "infinity", "-infinity"})


def read_columns(path: Path) -> dict[str, Array]:
    """All columns of the file that the project knows, each (n,); missing cells are NaN. Raises SweepError."""
    if path.suffix == ".parquet":
        return _read_parquet(path)
    try:
        raw = path.read_bytes()
        if path.suffix == ".gz" or raw[:2] == b"\x1f\x8b":
            raw = gzip.decompress(raw)
    except FileNotFoundError:
        raise SweepError(f"{path}: no such file; give the path of a sweep (CSV)") from None
    except IsADirectoryError:
        raise SweepError(f"{path}: is a folder; give the path of a sweep (CSV)") from None
    except (OSError, EOFError, zlib.error) as error:
        reason = getattr(error, "strerror", None) or error
        raise SweepError(f"{path.name}: cannot be read ({reason}); expected a CSV file, plain or gzip") from None
    return parse_csv(_decoded(raw, name=path.name), name=path.name)


def _decoded(raw: bytes, *, name: str) -> str:
    """The text of a file: UTF-8, UTF-16 with its mark, else Latin-1. Only comments and names can tell the last two."""
    encoding = _BYTE_ORDER_MARKS.get(raw[:2], "utf-8-sig")
    try:
        text = raw.decode(encoding)
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    binary = re.search("[\x00-\x08\x0e-\x1a]", text)
    if binary:
        line = text.count("\n", 0, binary.start()) + 1
        raise SweepError(
            f"{name}: line {line} holds the byte {ord(binary[0])}, so this is no text file; "
            "expected CSV: export the sweep as text"
        )
    return text


def parse_csv(text: str, *, name: str) -> dict[str, Array]:
    """The known columns of CSV text; lines that begin with # are comments. Raises SweepError."""
    # Not splitlines(): it also breaks at characters that editors do not count as the end of a line.
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    start = next((k for k, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")), None)
    if start is None:
        raise SweepError(f"{name}: the file is empty; expected a header line and one row per reading")
    delimiter = ";" if ";" in lines[start] else "\t" if "\t" in lines[start] else ","
    header = [cell.strip() for cell in _cells(lines[start], delimiter)]
    _check_header(header, where=f"{name}: line {start + 1}")
    body = [k for k in range(start + 1, len(lines)) if lines[k].strip() and not lines[k].lstrip().startswith("#")]
    if not body:
        raise SweepError(f"{name}: no row below the header of line {start + 1}; expected one row per reading")
    wanted = {cell: place for place, cell in enumerate(header) if cell in COLUMNS}
    table = _fast_table([lines[k] for k in body], delimiter, len(header))
    if table is None:
        table = _careful_table(lines, body, delimiter, header, name=name)
    return {cell: table[:, place].copy() for cell, place in wanted.items()}


def _check_header(header: list[str], *, where: str) -> None:
    found = _shown(",".join(header), 200)
    if all(_is_number(cell) for cell in header):
        raise SweepError(
            f"{where} holds {found} where the header is expected; "
            "put the column names above the numbers, e.g. reference_deg,measured_deg"
        )
    for cell in header:
        if cell in COLUMNS and header.count(cell) > 1:
            raise SweepError(f"{where}: column {cell} stands {header.count(cell)} times; expected it once: keep one")
    for needed in REQUIRED:
        if needed not in header:
            raise SweepError(f"{where}: column {needed} is missing; found {found}; rename the column or add it")


def _cells(line: str, delimiter: str) -> list[str]:
    """The cells of a line; the csv module is asked only where there are quotes for it to undo."""
    if '"' not in line:
        return line.split(delimiter)
    try:
        return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    except csv.Error:
        return [line]


def _shown(text: str, most: int = 40) -> str:
    """Text of a file as it may stand in a message."""
    return repr(text if len(text) <= most else text[:most] + "...")


def _fast_table(rows: list[str], delimiter: str, width: int) -> Array | None:
    """All cells at once where every one is a number; None where one is not, or a row is ragged."""
    try:
        table = np.loadtxt(rows, delimiter=delimiter, ndmin=2, comments=None, dtype=np.float64)
    except ValueError:
        return None
    return table if table.shape[1] == width else None


def _careful_table(lines: list[str], body: list[int], delimiter: str, header: list[str], *, name: str) -> Array:
    """Cell by cell, so that the first fault is named by line and column."""
    table = np.full((len(body), len(header)), np.nan)
    known = [cell in COLUMNS for cell in header]
    for row, k in enumerate(body):
        cells = _cells(lines[k], delimiter)
        if len(cells) != len(header):
            raise SweepError(
                f"{name}: line {k + 1} has {len(cells)} cells; expected {len(header)} as in the header "
                f"({_shown(','.join(header), 200)}); leave a cell empty where a reading is missing"
            )
        for place, cell in enumerate(cells):
            text = cell.strip()
            if not known[place] or text.lower() in _MISSING:
                continue
            # Where cells are not parted by commas, a comma is a decimal point.
            value = _number(text if delimiter == "," else text.replace(",", "."))
            if value is None:
                raise SweepError(
                    f"{name}: line {k + 1}, column {header[place]}: {_shown(text)} is not a number; "
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
    return text.strip().lower() in _MISSING or _number(text.strip().replace(",", ".")) is not None


def _read_parquet(path: Path) -> dict[str, Array]:
    try:
        import pyarrow.parquet as parquet  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError:
        raise SweepError(f"{path.name}: reading Parquet needs pyarrow; pip install pyarrow, or save as CSV") from None
    try:
        table = parquet.read_table(path)
    except Exception as error:
        raise SweepError(f"{path.name}: cannot be read as Parquet ({error}); expected a Parquet file") from None
    columns = {}
    for name in table.column_names:
        if name in COLUMNS:
            try:
                columns[name] = np.asarray(table.column(name).to_numpy(), dtype=np.float64)
            except (TypeError, ValueError) as error:
                raise SweepError(f"{path.name}: column {name}: {error}; expected numbers") from None
    return columns


def write_columns(path: Path, columns: Mapping[str, Array], *, comments: tuple[str, ...] = ()) -> None:
    """Write columns (each (n,)) as CSV, compressed where the name ends in .gz, whole or not at all."""
    content = csv_text(columns, comments=comments).encode()
    write_beside(path, gzip.compress(content, mtime=0) if path.suffix == ".gz" else content)


def csv_text(columns: Mapping[str, Array], *, comments: tuple[str, ...] = ()) -> str:
    """Columns (each (n,)) as the text of a CSV file, comments above the header."""
    out = io.StringIO()
    for comment in comments:
        out.write(f"# {comment}\n")
    out.write(",".join(columns) + "\n")
    cells = [[_cell(name, value, digits) for value in values] for name, values, digits in _with_digits(columns)]
    out.write("\n".join(",".join(row) for row in zip(*cells, strict=True)) + "\n")
    return out.getvalue()


def _with_digits(columns: Mapping[str, Array]) -> list[tuple[str, Array, int]]:
    """Each column with the digits it needs: clock times and angles over many turns are large numbers."""
    return [
        (name, values, 9 if np.nanmax(np.abs(values), initial=0.0) < 1e4 else 14) for name, values in columns.items()
    ]


def _cell(name: str, value: float, digits: int) -> str:
    if np.isnan(value):
        return ""
    if name in ("turn", "direction") and np.isfinite(value):
        return f"{int(value)}"
    return f"{value:.{digits}g}"
