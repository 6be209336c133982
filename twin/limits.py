"""One way to refuse a figure that is out of range: name, value, allowed range."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

from twin.errors import UserError
from twin.shown import shown


class OutOfRangeError(UserError):
    """A parameter lies outside its allowed range; the message names it, its value and the range."""


def require_within(name: str, value: Any, lower: float, upper: float, unit: str = "", *, whole: bool = False) -> None:
    """Check that every element of ``value`` lies in ``[lower, upper]`` (NaN does not). Raises OutOfRangeError."""
    if _plainly_within(value, lower, upper, whole=whole):
        return
    tail = f" {unit}" if unit else ""
    kind = "a whole number " if whole else ""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise OutOfRangeError(f"{name} is {shown(value)}; expected {kind}from {lower:g} to {upper:g}{tail}") from None
    bad = ~((array >= lower) & (array <= upper))
    if whole:
        bad |= array != np.round(array)
    if np.any(bad):
        found = np.ravel(array)[np.flatnonzero(np.ravel(bad))[0]]
        raise OutOfRangeError(f"{name} is {found:g}{tail}; expected {kind}from {lower:g} to {upper:g}{tail}")


def _plainly_within(value: Any, lower: float, upper: float, *, whole: bool) -> bool:
    """Whether it is a single number in range: most are, and an array of one costs fifteen times as much."""
    if not isinstance(value, int | float) or not lower <= value <= min(upper, sys.float_info.max):
        return False
    return not whole or value == round(value)
