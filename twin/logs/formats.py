"""Logs in formats of other programs, told by their first bytes and read by their libraries."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from twin.errors import SweepError
from twin.logs.buses import read_blf
from twin.logs.by_library import by_library
from twin.logs.cells import Row, table_of
from twin.logs.equal_lengths import of_arrays
from twin.logs.recorders import read_mdf, read_tdms
from twin.logs.table import Table

_ZIP, _HDF5, _PARQUET, _MATLAB = b"PK\x03\x04", b"\x89HDF\r\n\x1a\n", b"PAR1", b"MATLAB 5.0"
_MDF, _TDMS, _BLF = b"MDF     ", b"TDSm", b"LOGG"


def read_format(raw: bytes, path: Path, *, most: int) -> Table | None:
    """The table in a file of a known format, told by its first bytes; None for another.

    ``most``: bytes beyond which it is refused, after decompression. Raises SweepError.
    """
    file = path.name
    readers: tuple[tuple[bool, str, str, str, Callable[[io.BytesIO], Table]], ...] = (
        # MATLAB's newer files are HDF5 behind a header of 512 bytes.
        (raw.startswith(_HDF5) or raw[512:520] == _HDF5, "HDF5", "h5py", "formats", partial(_hdf5, file=file)),
        (raw.startswith(_MATLAB), "MAT", "scipy", "formats", partial(_matlab, file=file)),
        (raw.startswith(_PARQUET), "Parquet", "pyarrow", "formats", partial(_parquet, file=file, most=most)),
        (_packs(raw, "xl/"), "XLSX", "openpyxl", "formats", partial(_workbook, file=file, most=most)),
        (_packs(raw, ".npy"), "NPZ", "numpy", "formats", partial(_numpy, file=file, most=most)),
        (raw.startswith(_MDF), "MDF", "asammdf", "mdf", partial(read_mdf, file=file)),
        (raw.startswith(_TDMS), "TDMS", "nptdms", "formats", partial(read_tdms, file=file)),
        (raw.startswith(_BLF), "BLF", "can", "bench", partial(read_blf, path=path)),
    )
    for fits, word, library, extra, reader in readers:
        if fits:
            return by_library(partial(reader, io.BytesIO(raw)), word, library=library, extra=extra, file=file)
    return None


def _packs(raw: bytes, part: str) -> bool:
    """Whether a file is an archive of files in whose names this stands; in packed numbers any three bytes may."""
    if not raw.startswith(_ZIP):
        return False
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as archive:
            return any(part in name for name in archive.namelist())
    except zipfile.BadZipFile:
        # Cut short: what is left says what it was to be, and its library why it cannot be read.
        return part.encode() in raw


def _check_zip(raw: io.BytesIO, *, file: str, most: int) -> None:
    with zipfile.ZipFile(raw) as store:
        _check_size(sum(one.file_size for one in store.infolist()), file=file, most=most)
    raw.seek(0)


def _check_size(size: int, *, file: str, most: int) -> None:
    if size > most:
        raise SweepError(
            f"{file}: holds {size / 1e6:g} MB after decompression; expected at most {most / 1e6:g} MB; "
            "--max-size (max_bytes of Sweep.read) raises the limit"
        )


def _workbook(raw: io.BytesIO, *, file: str, most: int) -> Table:
    """The first sheet of a workbook with two columns of numbers."""
    from openpyxl import load_workbook  # type: ignore[import-untyped,unused-ignore]

    _check_zip(raw, file=file, most=most)
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
    return of_arrays({name: value for name, value in found.items() if not name.startswith("__")}, file=file)


def _numpy(raw: io.BytesIO, *, file: str, most: int) -> Table:
    _check_zip(raw, file=file, most=most)
    with np.load(raw, allow_pickle=False) as found:
        return of_arrays(dict(found), file=file)


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
    return of_arrays({name: np.squeeze(value) for name, value in arrays.items()}, file=file)


def _parquet(raw: io.BytesIO, *, file: str, most: int) -> Table:
    import pyarrow.parquet as parquet  # type: ignore[import-not-found,import-untyped,unused-ignore]

    held = parquet.ParquetFile(raw)
    # A column of one repeated value takes a few bytes in the file, and eight a row once it is read.
    _check_size(8 * held.metadata.num_rows * held.metadata.num_columns, file=file, most=most)
    table = held.read()
    return of_arrays({name: table.column(name).to_numpy() for name in table.column_names}, file=file)
