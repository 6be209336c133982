"""What the link says of itself: frames that are lost or doubled, rows with another status."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding, rows_shown
from diagnosis.setup.record import FEWEST, Record
from twin.angles import Array, IntArray

_MOST_STATES = 8
_MOST_LOST = 0.5


def lost_frames(record: Record) -> Finding | None:
    """A counter of frames that leaves numbers out, or repeats one."""
    if "frame" not in record.columns:
        return None
    frame = record.columns["frame"]
    known = np.flatnonzero(np.isfinite(frame))
    values = frame[known]
    if known.size < FEWEST or np.any(values % 1.0 != 0.0):
        return None
    apart = np.diff(record.numbers[known])
    usual = _commonest(np.diff(values) / apart)
    if usual < 0.0:
        # One that counts down counts up in its mirror image.
        values, usual = np.max(values) + np.min(values) - values, -usual
    if usual == 0.0:
        return None
    step = np.mod(np.diff(values), _modulus(values, apart, usual))
    wrong = step != usual * apart
    if not wrong.any() or wrong.mean() > _MOST_LOST:
        return None
    lost = int(np.sum(np.maximum(np.round(step[wrong] / usual) - apart[wrong], 0.0)))
    doubled = int(np.sum(step[wrong] == 0.0))
    rows = tuple(int(row) for row in record.numbers[known][1:][wrong])
    return Finding(
        kind="lost_frames",
        what="frames are missing or doubled",
        evidence=f"the counter leaves out {lost} and repeats {doubled}; before {rows_shown(rows)}",
        consequence="readings are attributed to the wrong angle or instant there, where rows stand for times or steps",
        remedy="read the bus without gaps (buffer, priority, rate); pair reference and reading by their own stamps",
        rows=rows,
    )


def _commonest(values: Array) -> float:
    """The value that comes most often in (n,); of two that come alike the larger."""
    each, counts = np.unique(values, return_counts=True)
    return float(each[each.size - 1 - int(np.argmax(counts[::-1]))])


def _modulus(values: Array, apart: IntArray, usual: float) -> float:
    """After how much a counter (n,) that goes on by ``usual`` in a row begins anew: 15, 100 or 256, as its wraps say.

    ``apart`` (n - 1,) is how many rows each value is behind the one before it.
    """
    change = np.diff(values)
    wraps = usual * apart[change < 0.0] - change[change < 0.0]
    # A smaller step back is a frame out of order, or a counter that was set to zero.
    wraps = wraps[wraps > np.ptp(values)]
    if wraps.size:
        wrap = _commonest(wraps)
        # One wrap alone is that of a counter if that begins anew at 0 or at its first step; else frames are lost there.
        if np.sum(wraps == wrap) > 1 or np.min(values) <= usual:
            return wrap
    most = max(float(np.max(np.abs(values))), 1.0)
    return float(2.0 ** max(int(np.ceil(np.log2(most + 1.0))), 1))


def other_status(record: Record) -> Finding | None:
    """Rows whose status is not the usual one."""
    if "status" not in record.columns:
        return None
    status = record.columns["status"]
    known = np.flatnonzero(np.isfinite(status))
    words, counts = np.unique(status[known], return_counts=True)
    if known.size < FEWEST or not 2 <= words.size <= _MOST_STATES:
        return None
    usual = float(words[int(np.argmax(counts))])
    other = known[status[known] != usual]
    # A bit that toggles is a counter or a phase, no fault.
    if other.size > 0.3 * known.size:
        return None
    rows = tuple(int(row) for row in record.numbers[other])
    return Finding(
        kind="other_status",
        what="the sensor says of some rows that something is wrong",
        evidence=f"status is {usual:g}, but {', '.join(f'{word:g}' for word in words if word != usual)} in "
        f"{len(rows)} rows: {rows_shown(rows)}",
        consequence="their readings may be no angles: errors of the magnet, the supply or the link",
        remedy="look the bits up in the sensor's data sheet, and leave these rows out",
        rows=rows,
    )
