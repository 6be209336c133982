"""Runs: the stretches of a record over which something stays as it is."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import numpy.typing as npt


def runs(values: npt.NDArray[Any]) -> tuple[slice, ...]:
    """The rows of each run of equal values (n,), in their order."""
    cuts = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist(), values.size]
    return tuple(slice(first, end) for first, end in itertools.pairwise(cuts) if end > first)
