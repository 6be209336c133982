"""Sweep files: CSV with units in the column names, comma or semicolon, plain or gzip; Parquet where pyarrow is."""

from __future__ import annotations

import csv
import gzip
import io
import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from twin.angles import Array
from twin.sweep import COLUMNS, SweepError

_MISSING = frozenset({"", "nan", "na", "n/a", "null", "none", "-", "inf", "+inf", "-inf", "infinity", "-infinity"})


def read_columns(path: Path) -> dict[str, Array]:
    """All columns of the file that the project knows, each (n,); missing cells are NaN. Raises SweepError."""
    if path.suffix == ".parquet":
        return _read_parquet(path)
    try:
        raw = path.read_bytes()
        if path.suffix == ".gz" or raw[:2] == b"\x1f\x8b":
            raw = gzip.decompress(raw)
        text = raw.decode("utf-8-sig")
    except FileNotFoundError:
        raise SweepError(f"{path.name}: no such file; give the path of a sweep (CSV)") from None
    except IsADirectoryError:
        raise SweepError(f"{path.name}: is a folder; give the path of a sweep (CSV)") from None
    except (OSError, EOFError) as error:
        raise SweepError(f"{path.name}: cannot be read ({error}); expected a CSV file, plain or gzip") from None
    except UnicodeDecodeError as error:
        raise SweepError(f"{path.name}: byte {error.start} is not UTF-8 text; expected a CSV file") from None
    return parse_csv(text, name=path.name)


def parse_csv(text: str, *, name: str) -> dict[str, Array]:
    """The known columns of CSV text; lines that begin with # are comments. Raises SweepError."""
    lines = text.splitlines()
    start = next((k for k, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")), None)
    if start is None:
        raise SweepError(f"{name}: the file is empty; expected a header line and one row per reading")
    delimiter = ";" if ";" in lines[start] else "\t" if "\t" in lines[start] and "," not in lines[start] else ","
    header = [cell.strip().strip('"').strip() for cell in lines[start].split(delimiter)]
    if all(_is_number(cell) for cell in header):
        raise SweepError(
            f"{name}: line {start + 1} holds numbers where the header is expected; "
            "put the column names above, e.g. reference_deg,measured_deg"
        )
    for cell in header:
        if cell in COLUMNS and header.count(cell) > 1:
            raise SweepError(f"{name}: line {start + 1}: column {cell} stands {header.count(cell)} times; keep one")
    body = [k for k in range(start + 1, len(lines)) if lines[k].strip() and not lines[k].lstrip().startswith("#")]
    if not body:
        raise SweepError(f"{name}: no row below the header of line {start + 1}; expected one row per reading")
    wanted = {cell: place for place, cell in enumerate(header) if cell in COLUMNS}
    table = _fast_table([lines[k] for k in body], delimiter, len(header))
    if table is None:
        table = _careful_table(lines, body, delimiter, header, name=name)
    return {cell: table[:, place].copy() for cell, place in wanted.items()}


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
        cells = next(csv.reader([lines[k]], delimiter=delimiter))
        if len(cells) != len(header):
            raise SweepError(
                f"{name}: line {k + 1} has {len(cells)} cells; expected {len(header)} ({delimiter.join(header)})"
            )
        for place, cell in enumerate(cells):
            text = cell.strip()
            if not known[place] or text.lower() in _MISSING:
                continue
            # With semicolons between cells a comma is a decimal point.
            value = _number(text.replace(",", ".") if delimiter == ";" else text)
            if value is None:
                raise SweepError(
                    f"{name}: line {k + 1}, column {header[place]}: {text[:40]!r} is not a number; "
                    "leave the cell empty where a reading is missing"
                )
            table[row, place] = value
    return table


def _number(text: str) -> float | None:
    try:
        return float(text)
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
        return {
            name: np.asarray(table.column(name).to_numpy(), dtype=np.float64)
            for name in table.column_names
            if name in COLUMNS
        }
    except Exception as error:
        raise SweepError(f"{path.name}: cannot be read as Parquet ({error})") from None


def write_columns(path: Path, columns: Mapping[str, Array], *, comments: tuple[str, ...] = ()) -> None:
    """Write columns (each (n,)) as CSV to a file beside ``path`` that then takes its name."""
    out = io.StringIO()
    for comment in comments:
        out.write(f"# {comment}\n")
    out.write(",".join(columns) + "\n")
    whole = {"turn", "direction"}
    cells = [
        [f"{int(v)}" if name in whole and np.isfinite(v) else "" if np.isnan(v) else f"{v:.9g}" for v in values]
        for name, values in columns.items()
    ]
    out.write("\n".join(",".join(row) for row in zip(*cells, strict=True)) + "\n")
    write_beside(
        path,
        gzip.compress(out.getvalue().encode(), mtime=0) if path.suffix == ".gz" else out.getvalue().encode(),
    )


def write_beside(path: Path, content: bytes) -> None:
    """Write a file whole or not at all: to a name beside it, then renamed."""
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        beside.write_bytes(content)
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)
