"""Long recordings: what is searched of them, so that a search takes no more time and memory than it needs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from diagnosis.discovery.fitting.observations import block_length
from twin.angles import Array, IntArray, radians, wrap
from twin.motion import Motion
from twin.sweep import Sweep

LONGEST = 24_000
"""Rows, after averaging, that are searched in full: at 0.03 deg of noise 0.001 deg is five sigma of them."""
LONGEST_SPIN = 4_000
"""The same of a log without a reference, all of whose rows have told its motion: at 0.03 deg of noise 0.003 deg is five
sigma."""
STRETCHES = 12


AT_ONCE = 1 << 20
"""Readings whose motion is told at once: that of ten million takes twice the memory that their columns do."""
_SHARED = 8
"""Readings that two pieces of a record share, so that a change of direction between them is seen."""


def searched_part(sweep: Sweep) -> Sweep:
    """The sweep, or where it is too long to be searched in full twelve stretches of it, spread over the record."""
    if len(sweep) > AT_ONCE and sweep.estimated is None and sweep.recordings is None:
        return _long_part(sweep)
    motion = sweep.motion()
    most = (LONGEST if sweep.estimated is None else LONGEST_SPIN) * block_length(motion)
    return sweep if len(sweep) <= most else sweep.part(stretches(motion, most))


def _long_part(sweep: Sweep) -> Sweep:
    """The twelve stretches of a sweep whose motion is told piece by piece."""
    blocks: list[int] = []
    reversals: list[int] = []
    for first, rows in _pieces(len(sweep)):
        motion = sweep.part(rows).motion()
        blocks.append(block_length(motion, len(sweep)))
        reversals += [first + turned for turned, _, _ in motion.segments[1:]]
    turned = np.unique(np.array(reversals, dtype=np.int64))
    return sweep.part(_spread(len(sweep), turned, radians(sweep.reference_deg), LONGEST * min(blocks)))


def _pieces(count: int) -> Iterator[tuple[int, IntArray]]:
    """The rows of so many in pieces that share a few, each with its first row."""
    for start in range(0, count, AT_ONCE):
        first = max(start - _SHARED, 0)
        yield first, np.arange(first, min(start + AT_ONCE, count))


def stretches(motion: Motion, most: int) -> IntArray:
    """Rows (most or fewer,) of twelve stretches of a motion (n,) that is longer than that.

    A stretch begins where the shaft stands as it stood at the end of the one before, so that it is not seen to jump,
    and takes in a reversal where there is one to be had.
    """
    reversals = np.array([first for first, _, _ in motion.segments[1:]], dtype=np.int64)
    return _spread(len(motion), reversals, motion.shaft_rad, most)


def _spread(n: int, reversals: IntArray, angle: Array, most: int) -> IntArray:
    """The rows of :func:`stretches` among ``n``, by the first rows after a reversal and the shaft's angles [rad]."""
    length = most // STRETCHES
    spacing = (n - length) / (STRETCHES - 1)
    rows = np.arange(length)
    for number in range(1, STRETCHES):
        start = round(number * spacing)
        near = reversals[np.abs(reversals - start - length // 2) <= spacing / 2 + 1]
        if near.size:
            start = int(near[0]) - (3 * length) // 4
        start = min(max(start, int(rows[-1]) + 1), n - length // 2)
        stop = min(start + length, n)
        start += _nearest(angle[start:stop], float(angle[rows[-1]]))
        rows = np.concatenate([rows, np.arange(start, stop)])
    return rows


def _nearest(angles: Array, angle: float) -> int:
    """Place in the first half of angles (m,) [rad] that is nearest to an angle."""
    return int(np.argmin(np.abs(wrap(angles[: max(angles.size // 2, 1)] - angle))))
