"""The running median: what a series does when single values, early, late or wild, are left out."""

from __future__ import annotations

import numpy as np

from twin.angles import Array

NEIGHBOURS = 9
"""Values whose median stands for the one in their middle: four wild ones among them do not move it."""


def running_median(values: Array) -> Array:
    """The median (n,) of each value and its neighbours, four on either side; at the ends they are mirrored."""
    padded = np.pad(values, NEIGHBOURS // 2, mode="reflect")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(padded, NEIGHBOURS), axis=-1))
