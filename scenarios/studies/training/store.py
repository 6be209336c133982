"""The Zarr store of training sweeps: made whole before the first sweep, then filled chunk by chunk through xarray."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.studies.study_folder import StudyFolder, part_of
from twin.errors import UserError

Arrays = Mapping[str, np.ndarray[Any, Any]]
STORE = "sweeps.zarr"
"""Name of the store in the study's folder."""
_BARE = "store"
"""The mark of the store without its sweeps."""
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
    folder: StudyFolder,
    one: Arrays,
    *,
    sweeps: int,
    chunk: int,
    coordinates: Arrays,
    attributes: Mapping[str, Any],
) -> None:
    """Make the store without its sweeps; nothing where it is there already. Raises UserError.

    ``one`` holds the variables (1, ...) of a single sweep, whose shapes and types tell those of the store;
    ``coordinates`` (n,) describe the readings; ``chunk`` sweeps are one file of each variable.
    """
    xr, dask_array = tools()
    damaged = folder.damaged(_BARE)
    if damaged == []:
        return
    for file in damaged or ():
        if file.exists():
            raise UserError(f"{file}: is not as this study wrote it; delete it and run the same command again")
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
    try:
        with folder.workspace() as beside, warnings.catch_warnings():
            # zarr warns that the collected metadata, which one request reads, is younger than the format.
            warnings.simplefilter("ignore")
            dataset.to_zarr(beside / STORE, compute=False, encoding=encoding)
            folder.mark(_BARE, folder.place(_BARE, beside))
    except OSError as error:
        raise UserError(
            f"{folder.path / STORE}: cannot be written ({error.strerror}); make room and run the same command again"
        ) from None


def write_region(folder: StudyFolder, chunk: int, numbers: range, arrays: Arrays) -> list[Path]:
    """Write the sweeps with these numbers, which are one chunk of every variable; its files.

    Raises UserError where somebody's file is in the place of one, and OSError.
    """
    xr, _ = tools()
    dataset = xr.Dataset({name: (_DIMS[name], values) for name, values in arrays.items()})
    with folder.workspace() as beside, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # zarr writes into a store as it is without its sweeps, and the files move from there.
        bare = folder.copied(_BARE, beside)
        dataset.to_zarr(beside / STORE, region={"sweep": slice(numbers.start, numbers.stop)})
        for file in bare:
            file.unlink()
        # A chunk of nothing but zeros has no file.
        return folder.place(part_of(chunk), beside)


def tools() -> tuple[Any, Any]:
    """xarray and dask.array. Raises UserError where they, or zarr, are not installed."""
    try:
        import dask.array
        import xarray

        # xarray writes through it.
        import_module("zarr")
    except ImportError:
        raise UserError(
            "halltwin generate needs xarray, zarr and dask; pip install '.[sweeps]' in the checkout"
        ) from None
    return xarray, dask.array
