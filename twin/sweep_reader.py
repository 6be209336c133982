"""Reading a sweep: a file of its own columns as CSV or Parquet, told by its first bytes, or a log by a statement."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from twin.angles import Array
from twin.bounded_input import LARGEST_SWEEP_BYTES, blocks, checked_bytes
from twin.errors import SweepError, UserError
from twin.sweep_columns import COLUMNS, TOLD_BY_SENSOR
from twin.sweep_text import parse_csv

if TYPE_CHECKING:
    from twin.logs.guess import Guess

RAISED_BY = "--max-size (max_bytes of Sweep.read)"
_EXPECTED = "a sweep (CSV)"
_PARQUET = b"PAR1"
_Checked = TypeVar("_Checked")


def read_sweep(
    path: Path,
    checked: Callable[[Mapping[str, Array]], _Checked],
    *,
    columns: str | None = None,
    max_bytes: int = LARGEST_SWEEP_BYTES,
    spin: bool = False,
    guess: bool = False,
) -> tuple[_Checked, Guess | None]:
    """The columns of a file, checked: those of a sweep as they are, or a log's by a statement, which is given, too.

    The statement is ``columns``, or with ``guess`` the one that fits, if that is one alone. ``spin``: a log without a
    reference will do, see :func:`twin.sweep_columns.is_spin`.
    The message for a file that is refused ends with the statement that would read it, if any. Raises SweepError.
    """
    if columns is not None:
        from twin.logs.read import read_log

        log = read_log(path, columns=columns, max_bytes=max_bytes)
        return checked(log.columns), log.guess
    try:
        return checked(read_columns(path, max_bytes=max_bytes, spin=spin)), None
    except SweepError as error:
        from twin.logs.unasked import Unread

        unread = Unread(path, error, max_bytes=max_bytes, spin=spin)
    log = unread.log()
    return unread.checked(log, checked, guess=guess), log.guess


def read_columns(path: Path, *, max_bytes: int = LARGEST_SWEEP_BYTES, spin: bool = False) -> dict[str, Array]:
    """All columns of the file that the project knows, each (n,); missing cells are NaN.

    ``max_bytes``: most bytes after decompression; ``spin``: those of a log without a reference will
    do. Raises SweepError.
    """
    try:
        max_bytes = checked_bytes(max_bytes)
        content = blocks(path, most=max_bytes, expected=_EXPECTED, raised_by=RAISED_BY)
        first = next(content, b"")
        if first[:4] == _PARQUET:
            return _read_parquet(path, max_bytes=max_bytes)
        return parse_csv(itertools.chain((first,), content), name=path.name, spin=spin)
    except SweepError:
        raise
    except UserError as error:
        raise SweepError(str(error)) from None


def _read_parquet(path: Path, *, max_bytes: int) -> dict[str, Array]:
    if not path.is_file():
        raise SweepError(f"{path.name}: holds Parquet, which is no stream; give the file itself, or CSV")
    try:
        import pyarrow.parquet as parquet  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError:
        needs = "needs pyarrow; pip install '.[formats]' in the checkout, or save as CSV"
        raise SweepError(f"{path.name}: reading Parquet {needs}") from None
    try:
        file = parquet.ParquetFile(path)
        known = [name for name in COLUMNS if name in file.schema_arrow.names]
        # A column of one repeated value takes a few bytes in the file, and eight a row once it is read.
        size = file.metadata.num_rows * max(len(known), 1) * 8
        table = file.read(columns=known) if size <= max_bytes else None
    except Exception as error:
        said = " ".join(str(error).split())[:200]
        raise SweepError(f"{path.name}: cannot be read as Parquet ({said}); expected a Parquet file") from None
    if table is None:
        raise SweepError(
            f"{path.name}: holds {size / 1e6:g} MB in {file.metadata.num_rows} rows; expected at most "
            f"{max_bytes / 1e6:g} MB; {RAISED_BY} raises the limit"
        )
    columns = {}
    for name in known:
        try:
            columns[name] = np.asarray(table.column(name).to_numpy(), dtype=np.float64)
        except (TypeError, ValueError) as error:
            if name in TOLD_BY_SENSOR:
                continue
            raise SweepError(f"{path.name}: column {name}: {error}; expected numbers") from None
    return columns
