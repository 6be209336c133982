"""Where an angle in a column begins anew."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, BoolArray

_SHARE = 0.5
"""A step of more than this share of the span is where an angle begins anew."""


def restarts(values: Array) -> BoolArray:
    """Whether an angle begins anew after each but the last of some values (n,), whatever its unit."""
    return np.asarray(np.abs(np.diff(values)) > _SHARE * np.ptp(values))
