"""Logs in formats of other programs: workbooks, MATLAB, numpy, HDF5 and Parquet, each by its own library."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from twin.errors import SweepError
from twin.logs.cells import Row, table_of
from twin.logs.table import Table

_ZIP, _HDF5, _PARQUET, _MATLAB = b"PK\x03\x04", b"\x89HDF\r\n\x1a\n", b"PAR1", b"MATLAB 5.0"
_EXTRA = "pip install '.[formats]' in the checkout"


def read_format(raw: bytes, *, file: str) -> Table | None:
    """The table in a file of a known format, told by its first bytes; None for another. Raises SweepError."""
    readers: tuple[tuple[bool, str, Callable[..., Table]], ...] = (
        # MATLAB's newer files are HDF5 behind a header of 512 bytes.
        (raw.startswith(_HDF5) or raw[512:520] == _HDF5, "HDF5", _hdf5),
        (raw.startswith(_MATLAB), "MAT", _matlab),
        (raw.startswith(_PARQUET), "Parquet", _parquet),
        (raw.startswith(_ZIP) and b"xl/" in raw, "XLSX", _workbook),
        (raw.startswith(_ZIP) and b".npy" in raw, "NPZ", _numpy),
    )
    for fits, word, reader in readers:
        if not fits:
            continue
        try:
            return reader(io.BytesIO(raw), file=file)
        except SweepError:
            raise
        except ImportError as error:
            raise SweepError(f"{file}: reading {word} needs {error.name}; {_EXTRA}, or save as CSV") from None
        except Exception as error:
            said = " ".join(str(error).split())[:200]
            raise SweepError(
                f"{file}: cannot be read as {word} ({said}); expected a whole file: save it again"
            ) from None
    return None


def _workbook(raw: io.BytesIO, *, file: str) -> Table:
    """The first sheet of a workbook with two columns of numbers."""
    from openpyxl import load_workbook  # type: ignore[import-untyped,unused-ignore]

    book = load_workbook(raw, read_only=True, data_only=True)
    first: SweepError | None = None
    for sheet in book.worksheets:
        rows = [
            Row(k, tuple(_cell(value) for value in values))
            for k, values in enumerate(sheet.iter_rows(values_only=True), start=1)
        ]
        width = max((len(row.cells) for row in rows), default=0)
        # What is formatted and empty belongs to no column.
        used = [k for k in range(width) if any(len(row.cells) > k and row.cells[k] for row in rows)]
        kept = [Row(row.number, tuple(row.cells[k] for k in used)) for row in rows if any(row.cells)]
        aside = tuple(name for name in book.sheetnames if name != sheet.title)
        notes = (f"sheet {sheet.title!r}", *(f"sheet {name!r} is not used" for name in aside))
        try:
            return table_of(_headed(kept), (), file=file, comma_parts=False, notes=notes)
        except SweepError as error:
            first = first or error
    raise first or SweepError(f"{file}: the workbook has no sheet; expected a table of numbers")


def _headed(rows: list[Row]) -> list[Row]:
    """The rows, those of remarks in fewer cells cut behind their last one: a title above the table is no header."""
    if not rows:
        return rows
    width = len(rows[-1].cells)
    return [
        row if all(row.cells) or row is rows[-1] or sum(map(bool, row.cells)) > width / 2 else _cut(row) for row in rows
    ]


def _cut(row: Row) -> Row:
    last = max(k for k, cell in enumerate(row.cells) if cell)
    return Row(row.number, row.cells[: last + 1])


def _cell(value: Any) -> str:
    return "" if value is None else str(value).strip()


def _matlab(raw: io.BytesIO, *, file: str) -> Table:
    from scipy.io import loadmat

    found = loadmat(raw, squeeze_me=True)
    return _of_arrays({name: value for name, value in found.items() if not name.startswith("__")}, file=file)


def _numpy(raw: io.BytesIO, *, file: str) -> Table:
    with np.load(raw, allow_pickle=False) as found:
        return _of_arrays(dict(found), file=file)


def _hdf5(raw: io.BytesIO, *, file: str) -> Table:
    import h5py  # type: ignore[import-untyped,unused-ignore]

    arrays: dict[str, Any] = {}

    def take(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            unit = item.attrs.get("units", item.attrs.get("unit", ""))
            unit = unit.decode(errors="replace") if isinstance(unit, bytes) else str(unit)
            arrays[f"{name.replace('/', '.')}{f' [{unit}]' if unit else ''}"] = item[()]

    with h5py.File(raw, "r") as store:
        store.visititems(take)
    return _of_arrays({name: np.squeeze(value) for name, value in arrays.items()}, file=file)


def _parquet(raw: io.BytesIO, *, file: str) -> Table:
    import pyarrow.parquet as parquet  # type: ignore[import-not-found,import-untyped,unused-ignore]

    table = parquet.read_table(raw)
    return _of_arrays({name: table.column(name).to_numpy() for name in table.column_names}, file=file)


def _of_arrays(arrays: Mapping[str, Any], *, file: str) -> Table:
    """The arrays of the most common length as columns; tables of numbers give one for each of theirs."""
    flat = list(_flat(arrays))
    columns = [(name, values) for name, values in flat if values is not None and values.size > 1]
    lengths = [values.size for _, values in columns]
    rows = max(set(lengths), key=lambda n: (lengths.count(n), n), default=0)
    kept = [(name, values) for name, values in columns if values.size == rows]
    if len(kept) < 2:
        raise SweepError(f"{file}: holds no two columns of numbers of one length; expected a reference and a sensor")
    left = tuple(
        f"{name} (no column of {rows} numbers)" for name, values in flat if values is None or values.size != rows
    )
    return Table(file, tuple(name for name, _ in kept), tuple(values for _, values in kept), left=left)


def _flat(arrays: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Each column (n,) by its full name, also the fields of structures and columns of tables; None: no numbers."""
    for own, value in arrays.items():
        name, array = f"{before}{own}", np.squeeze(np.asarray(value))
        if array.dtype.names:
            fields = {field: array[field].item() if array.ndim == 0 else array[field] for field in array.dtype.names}
            yield from _flat(fields, f"{name}.")
        elif array.dtype.kind not in "fiub" or array.ndim > 2:
            yield name, None
        elif array.ndim == 2:
            across = array.T if array.shape[0] > array.shape[1] else array
            yield from ((f"{name}.{k + 1}", part.astype(np.float64)) for k, part in enumerate(across))
        else:
            yield name, np.atleast_1d(array).astype(np.float64)
