"""Channels that were recorded on clocks of their own, brought to one: that of the slowest angle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.errors import SweepError
from twin.logs.names import meaning_of
from twin.logs.restarts import restarts
from twin.logs.table import Table

_FEWEST = 8
_GAP = 5.0
"""Times the typical interval from which what lies between two samples is a gap: nothing is made up in it."""


@dataclass(frozen=True, eq=False)
class Channel:
    """What one channel recorded: its name with its unit in brackets, values (n,) and their times [s] (n,)."""

    name: str
    time_s: Array
    values: Array


def on_one_clock(channels: Sequence[Channel], *, file: str, left: Sequence[str] = ()) -> Table:
    """The channels as columns of one table, with their time. Raises SweepError where there are not two.

    Channels of other clocks are interpolated linearly between two samples that follow each other; in a gap, and where
    an angle begins anew, the cell is missing. ``left`` is what the file holds beside channels of numbers.
    """
    usable = [one for one in channels if one.values.size >= _FEWEST]
    if len(usable) < 2:
        raise SweepError(
            f"{file}: holds {len(usable)} channels of {_FEWEST} samples and more; expected a reference and a sensor"
        )
    angles = [one for one in usable if meaning_of(one.name).role == "angle"]
    base = min(angles if len(angles) > 1 else usable, key=lambda one: one.values.size)
    time_s = base.time_s
    own = [one.time_s.size == time_s.size and np.array_equal(one.time_s, time_s) for one in usable]
    values = [one.values if same else _between(one, time_s) for one, same in zip(usable, own, strict=True)]
    moved = ", ".join(one.name for one, same in zip(usable, own, strict=True) if not same)
    notes = (f"{moved}: interpolated to the times of {base.name}",) if moved else ()
    few = [f"{one.name} ({one.values.size} samples)" for one in channels if one.values.size < _FEWEST]
    names = ("time [s]", *(one.name for one in usable))
    return Table(file, names, (time_s, *values), notes=notes, left=(*left, *few))


def _between(channel: Channel, time_s: Array) -> Array:
    """The values (m,) of a channel at other times [s] (m,); NaN where it has none."""
    steps = np.diff(channel.time_s)
    after = np.clip(np.searchsorted(channel.time_s, time_s), 1, channel.values.size - 1)
    found = np.interp(time_s, channel.time_s, channel.values, left=np.nan, right=np.nan)
    gaps = steps > _GAP * np.median(steps)
    exact = np.isclose(time_s, channel.time_s[after], rtol=0.0, atol=1e-9)
    found[(restarts(channel.values) | gaps)[after - 1] & ~exact] = np.nan
    return found
