"""A column that stands still while the shaft goes on."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.record import FEWEST, Record
from twin.angles import Array, wrap_deg

_LEAST_DEG = 30.0
"""The other side goes on by this much at least: a word's dead zone is narrower, and so is a stop of the shaft."""
_TIMES_USUAL = 6.0
"""And by so many times what it usually does at one value, which a coarse grid or a slow shaft makes long."""
_WORDS = {"reference_deg": "the reference", "measured_deg": "the sensor's reading", "vx": "vx", "vy": "vy"}


def frozen(record: Record) -> Finding | None:
    """An angle or a channel that is constant, from one end to the other or for a stretch."""
    if record.both.size < FEWEST:
        return None
    for name, words in _WORDS.items():
        values = record.column(name)
        if values is None or not np.isfinite(values).all():
            continue
        other = record.measured_deg if name == "reference_deg" else record.reference_deg
        found = _stretch(values, other, of_channel=name in ("vx", "vy"))
        if found is None:
            continue
        first, last, moved_deg = found
        whole = last - first + 1 == values.size
        rows = record.rows(np.arange(first, last + 1))
        return Finding(
            kind="frozen",
            what=f"{words} stands still while the shaft goes on",
            evidence=f"{name} is {values[first]:g} in {'every row' if whole else f'rows {rows[0]} to {rows[-1]}'}, "
            f"while the other angle moves by {moved_deg:.0f} deg",
            consequence="these rows hold no reading: what they seem to show is the link's or the recorder's",
            remedy="mend the link (chip select, bus, a recorder that repeats the last value) and record again"
            + ("" if whole else ", or take the rows out"),
            rows=rows,
        )
    return None


def _stretch(values: Array, other_deg: Array, *, of_channel: bool) -> tuple[int, int, float] | None:
    """First and last place of the longest stretch at one value, and how far the other side moved over it."""
    cuts = np.flatnonzero(np.diff(values) != 0.0) + 1
    starts, ends = np.concatenate([[0], cuts]), np.concatenate([cuts, [values.size]])
    path = np.concatenate([[0.0], np.cumsum(np.abs(wrap_deg(np.diff(other_deg))))])
    # What scatters about one place is no way on: it counts as far as it gets, not how long it takes.
    moved = np.array([_reach(other_deg[a:b]) for a, b in zip(starts, ends, strict=True)])
    if of_channel and starts.size > 1:
        # A channel that clips stays at its largest or smallest value.
        moved[(values[starts] == values.max()) | (values[starts] == values.min())] = 0.0
    longest = int(np.argmax(moved))
    usual = float(path[-1]) / starts.size if starts.size > 1 else 0.0
    if moved[longest] < max(_LEAST_DEG, _TIMES_USUAL * usual) or ends[longest] - starts[longest] < 4:
        return None
    return int(starts[longest]), int(ends[longest]) - 1, float(moved[longest])


def _reach(angle_deg: Array) -> float:
    """How far an angle (n,) gets from where it was, over its turns."""
    if angle_deg.size < 2:
        return 0.0
    return float(np.ptp(np.unwrap(angle_deg, period=360.0)))
