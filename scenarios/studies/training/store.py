"""The Zarr store of training sweeps: made whole before the first sweep, then filled chunk by chunk through xarray."""

from __future__ import annotations

import shutil
import warnings
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from twin.errors import UserError

Arrays = Mapping[str, np.ndarray[Any, Any]]
_DIMS = {
    "error_deg": ("sweep", "reading"),
    "channels": ("sweep", "channel", "reading"),
    "labels": ("sweep", "cause"),
    "strength_deg": ("sweep", "cause"),
    "parameters": ("sweep", "parameter"),
    "noise_deg": ("sweep",),
    "mean_deg": ("sweep",),
    "split": ("sweep",),
}
_ABOUT = {
    "error_deg": "measured minus reference [deg], about its circular mean",
    "channels": "x and y as the converter hands them on, nominal amplitude 1",
    "labels": "1 where the cause acts",
    "strength_deg": "strength of each cause: about the amplitude of its angle error [deg], 0 where it does not act",
    "parameters": "every parameter that was drawn, in its own unit",
    "noise_deg": "RMS of the noise in the angle [deg]",
    "mean_deg": "circular mean that error_deg was taken about [deg]",
    "split": "0 train, 1 validation, 2 test",
}


def create(
    path: Path,
    one: Arrays,
    *,
    sweeps: int,
    chunk: int,
    coordinates: Arrays,
    attributes: Mapping[str, Any],
) -> None:
    """Make the store without its sweeps, whole or not at all; nothing where it is there already. Raises UserError.

    ``one`` holds the variables (1, ...) of a single sweep, whose shapes and types tell those of the store;
    ``coordinates`` (n,) describe the readings; ``chunk`` sweeps are one file of each variable.
    """
    xr, dask_array = _tools()
    if path.exists():
        return
    variables = {
        name: (
            _DIMS[name],
            dask_array.zeros((sweeps, *part.shape[1:]), chunks=(chunk, *part.shape[1:]), dtype=part.dtype),
            {"about": _ABOUT[name]},
        )
        for name, part in one.items()
    }
    readings = {name: ("reading", values) for name, values in coordinates.items()}
    dataset = xr.Dataset(variables, coords=readings, attrs=attributes)
    encoding = {name: {"chunks": (chunk, *part.shape[1:]), "_FillValue": None} for name, part in one.items()}
    beside = path.with_name(f".{path.name}.part")
    shutil.rmtree(beside, ignore_errors=True)
    try:
        with warnings.catch_warnings():
            # zarr warns that the collected metadata, which one request reads, is younger than the format.
            warnings.simplefilter("ignore")
            dataset.to_zarr(beside, compute=False, encoding=encoding)
        beside.rename(path)
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); make room and run the command again") from None


def write_region(path: Path, numbers: range, arrays: Arrays) -> None:
    """Write the sweeps with these numbers, which are one chunk of every variable. Raises OSError."""
    xr, _ = _tools()
    dataset = xr.Dataset({name: (_DIMS[name], values) for name, values in arrays.items()})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        dataset.to_zarr(path, region={"sweep": slice(numbers.start, numbers.stop)})


def _tools() -> tuple[Any, Any]:
    try:
        import dask.array
        import xarray

        # xarray writes through it.
        import_module("zarr")
    except ImportError:
        raise UserError("halltwin generate needs xarray, zarr and dask; pip install 'halltwin[sweeps]'") from None
    return xarray, dask.array
