"""Angles on the circle: wrapping, unwrapping and the type of array the project works on."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Numbers of any shape, in double precision."""
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
_ROUNDING_RAD = 1e-11
"""Of an angle that has gone round thousands of times."""
TAU = 2.0 * np.pi


def wrap(angle: Any) -> Array:
    """Angle [rad], any shape, brought to [-pi, pi)."""
    return np.asarray((np.asarray(angle) + np.pi) % TAU - np.pi, dtype=np.float64)


def within_turn(angle: Array) -> Array:
    """An angle [rad] in [0, 2 pi), the rounding of a double below a whole turn as 0."""
    return np.asarray(np.mod(angle + _ROUNDING_RAD, TAU))


def wrap_deg(angle: Any) -> Array:
    """Angle [deg], any shape, brought to [-180, 180)."""
    return np.asarray((np.asarray(angle) + 180.0) % 360.0 - 180.0, dtype=np.float64)


def channels_of(x: Any, y: Any) -> Array:
    """Two channels, each broadcastable to (..., 1, n), stacked to (..., 2, n)."""
    x, y = np.broadcast_arrays(x, y)
    return np.concatenate([x, y], axis=-2)


def radians(value: Any) -> Array:
    """Degrees to radians, any shape."""
    return np.asarray(np.radians(value), dtype=np.float64)
