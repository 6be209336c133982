"""Logs of a CAN bus in the formats of python-can: their frames are decoded by the DBC that lies beside the log."""

from __future__ import annotations

import io
import re
from collections import defaultdict
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from twin.errors import SweepError
from twin.logs.by_library import by_library
from twin.logs.clocks import Channel, on_one_clock
from twin.logs.table import Table

_CANDUMP = re.compile(r"\(\d+\.\d+\) +\S+ +[0-9A-Fa-f]{3,8}#")
_ASC = re.compile(r"(?:date .*\s+)?base +(?:hex|dec)\b", re.IGNORECASE)
_TRC = ";$FILEVERSION"


def read_blf(raw: io.BytesIO, *, path: Path) -> Table:
    """The signals in a log of Vector's binary format. Raises SweepError."""
    import can

    return _decoded(can.BLFReader(raw), path)


def read_bus_text(text: str, path: Path) -> Table | None:
    """The signals in a log of frames as text (ASC, TRC, candump); None for any other text. Raises SweepError."""
    head = text[:2000].lstrip("\ufeff \t\r\n")
    formats = (
        (head.startswith(_TRC), "TRC", "TRCReader"),
        (_ASC.match(head) is not None, "ASC", "ASCReader"),
        (_CANDUMP.match(head) is not None, "a log of candump", "CanutilsLogReader"),
    )
    for fits, word, reader in formats:
        if fits:
            return by_library(partial(_of_text, text, reader, path), word, library="can", extra="bench", file=path.name)
    return None


def _of_text(text: str, reader: str, path: Path) -> Table:
    import can

    return _decoded(getattr(can, reader)(io.StringIO(text)), path)


def _decoded(frames: Iterable[Any], path: Path) -> Table:
    """The signals of all frames that the DBC knows, those of one message on one clock. Raises SweepError."""
    import cantools

    named = _dbc_of(path)
    database: Any = cantools.database.load_file(str(named))
    messages = {(one.frame_id, one.is_extended_frame): one for one in database.messages}
    times: dict[str, list[float]] = defaultdict(list)
    values: dict[str, list[float]] = defaultdict(list)
    unknown: set[int] = set()
    for frame in frames:
        message = messages.get((frame.arbitration_id, frame.is_extended_id))
        if message is None or frame.is_error_frame or frame.is_remote_frame:
            unknown.add(frame.arbitration_id)
            continue
        for name, value in message.decode(bytes(frame.data), decode_choices=False, allow_truncated=True).items():
            signal = message.get_signal_by_name(name)
            key = f"{message.name}.{name}{f' [{signal.unit}]' if signal.unit else ''}"
            times[key].append(frame.timestamp)
            values[key].append(float(value))
    if not values:
        raise SweepError(f"{path.name}: {named.name} knows none of its frames; expected the DBC of this bus beside it")
    channels = [Channel(key, np.array(times[key]), np.array(each)) for key, each in values.items()]
    left = [f"frames {', '.join(f'{one:#x}' for one in sorted(unknown)[:5])} (not in {named.name})"] if unknown else []
    return on_one_clock(channels, file=path.name, left=left)


def _dbc_of(path: Path) -> Path:
    """The DBC of a log: of the same name beside it, else the only one in its folder. Raises SweepError."""
    own = path.with_suffix(".dbc")
    beside = [own] if own.is_file() else sorted(path.parent.glob("*.dbc"))
    if len(beside) != 1:
        raise SweepError(
            f"{path.name}: holds frames of a bus, and {len(beside)} .dbc files lie beside it; expected the one that "
            f"says what they hold: put it there as {own.name}"
        )
    return beside[0]
