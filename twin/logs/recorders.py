"""Logs of measurement systems: MDF of version 4 and TDMS, each by its own library."""

from __future__ import annotations

import gc
import io
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np

from twin.errors import SweepError
from twin.logs.clocks import Channel, on_one_clock
from twin.logs.equal_lengths import of_arrays
from twin.logs.table import Table


def read_mdf(raw: io.BytesIO, *, file: str) -> Table:
    """The channels of a measurement file. Raises SweepError."""
    channels, left = [], []
    with _opened_mdf(raw, file=file) as store:
        for signal in store.iter_channels(skip_master=True):
            values = _numbers(signal.samples)
            if values is None:
                left.append(f"{signal.name} (no column of numbers)")
            else:
                time_s = np.asarray(signal.timestamps, dtype=np.float64)
                channels.append(Channel(_named(signal.name, signal.unit), time_s, values))
    return on_one_clock(channels, file=file, left=left)


def _opened_mdf(raw: io.BytesIO, *, file: str) -> Any:
    from asammdf import MDF  # type: ignore[import-not-found,import-untyped,unused-ignore]

    told = sys.unraisablehook
    # What asammdf has half opened complains on standard error when it goes: that is here, with the error's frames.
    sys.unraisablehook = lambda _: None
    try:
        return MDF(raw)
    except Exception as error:
        said = " ".join(str(error).split())[:200]
        error.__traceback__ = None
        gc.collect()
    finally:
        sys.unraisablehook = told
    raise SweepError(f"{file}: cannot be read as MDF ({said}); expected a whole file: save it again")


def read_tdms(raw: io.BytesIO, *, file: str) -> Table:
    """The channels of a file of LabVIEW, by their clocks where all have one, else those of one length.

    Raises SweepError.
    """
    from nptdms import TdmsFile  # type: ignore[import-not-found,import-untyped,unused-ignore]

    found = {
        _named(path, channel.properties.get("unit_string")): channel for path, channel in _tdms(TdmsFile.read(raw))
    }
    numbers = {name: _numbers(channel[:]) for name, channel in found.items()}
    if not all(found[name].properties.get("wf_increment") for name, values in numbers.items() if values is not None):
        return of_arrays({name: channel[:] for name, channel in found.items()}, file=file)
    channels = [Channel(name, found[name].time_track(), v) for name, v in numbers.items() if v is not None]
    left = [f"{name} (no column of numbers)" for name, values in numbers.items() if values is None]
    return on_one_clock(channels, file=file, left=left)


def _tdms(store: Any) -> Iterator[tuple[str, Any]]:
    groups = store.groups()
    for group in groups:
        for channel in group.channels():
            yield channel.name if len(groups) == 1 else f"{group.name}.{channel.name}", channel


def _named(name: str, unit: str | None) -> str:
    return f"{name} [{unit.strip()}]" if unit and unit.strip() else name


def _numbers(samples: Any) -> np.ndarray | None:
    """Samples (n,) as numbers; None for words, structures and tables."""
    values = np.asarray(samples)
    return values.astype(np.float64) if values.ndim == 1 and values.dtype.kind in "fiub" else None
