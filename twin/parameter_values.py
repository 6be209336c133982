"""Values of an effect's parameters as arrays: checked as they are given, shaped as effects take them."""

from __future__ import annotations

from typing import Any

import numpy as np

from twin.angles import Array
from twin.effect import Effect


def numbers(value: Any) -> Array:
    """A parameter as an array; a whole number beyond all floating-point numbers is as good as infinite."""
    try:
        return np.asarray(value, dtype=np.float64)
    except OverflowError:
        return np.asarray(np.inf)


def aligned(value: Any, effect: Effect, name: str) -> Any:
    """A parameter as effects take it: a scalar, or an array (batch, 1, 1); per turn (turns,) or (batch, 1, turns)."""
    array = np.asarray(value, dtype=np.float64)
    if array.ndim == 0:
        return float(array)
    if effect.params[name].role == "per turn":
        return array if array.ndim == 1 else array[:, None, :]
    return array[:, None, None] if array.ndim == 1 else array
