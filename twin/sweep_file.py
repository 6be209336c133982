"""Sweeps as files: columns as CSV, with as many digits as they need; :mod:`twin.sweep_reader` reads them back."""

from __future__ import annotations

import gzip
import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from twin.angles import Array
from twin.ending import ending_of
from twin.whole_file import write_beside


def write_columns(path: Path, columns: Mapping[str, Array], *, comments: tuple[str, ...] = ()) -> None:
    """Write columns (each (n,)) as CSV, compressed where the name ends in .gz, whole or not at all."""
    content = csv_text(columns, comments=comments).encode()
    write_beside(path, gzip.compress(content, mtime=0) if ending_of(path).endswith(".gz") else content)


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
