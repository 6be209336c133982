"""Long recordings: what is searched of them, so that a search takes no more time and memory than it needs."""

from __future__ import annotations

import numpy as np

from diagnosis.evidence import block_length
from twin.angles import Array, wrap
from twin.sweep import Sweep

LONGEST = 24_000
"""Rows, after averaging, that are searched in full: at 0.03 deg of noise 0.001 deg is five sigma of them."""
STRETCHES = 12


def searched_part(sweep: Sweep) -> Sweep:
    """The sweep, or where it is too long to be searched in full twelve stretches of it, evenly spaced over the record.

    A stretch begins where the reference stands as it stood at the end of the one before, so that the shaft is not seen
    to jump.
    """
    block = block_length(sweep.motion())
    n = len(sweep)
    if n <= LONGEST * block:
        return sweep
    length = LONGEST * block // STRETCHES
    spacing = (n - length) / (STRETCHES - 1)
    reference = np.radians(sweep.reference_deg)
    rows = np.arange(length)
    for number in range(1, STRETCHES):
        start = max(round(number * spacing), int(rows[-1]) + 1)
        stop = min(start + length, n)
        start += _nearest(reference[start:stop], float(reference[rows[-1]]))
        rows = np.concatenate([rows, np.arange(start, stop)])
    return sweep.part(rows)


def _nearest(angles: Array, angle: float) -> int:
    """Place in the first half of angles (m,) [rad] that is nearest to an angle."""
    return int(np.argmin(np.abs(wrap(angles[: max(angles.size // 2, 1)] - angle))))
