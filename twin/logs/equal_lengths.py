"""Arrays of one length as the columns of a table: the fields of structures, the columns of tables, single arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from twin.errors import SweepError
from twin.logs.table import Table


def of_arrays(arrays: Mapping[str, Any], *, file: str) -> Table:
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
