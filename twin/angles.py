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
_PIECE = 8192
"""Numbers of a row that stays in the processor's cache beside a few others."""


def wrap(angle: Any) -> Array:
    """Angle [rad], any shape, brought to [-pi, pi)."""
    shifted = np.asarray(np.asarray(angle) + np.pi, dtype=np.float64)
    if shifted.size < _PIECE:
        return np.asarray(shifted % TAU - np.pi)
    # Of many angles most are there already: the remainder, ten times as slow as the rest, is taken of the others alone.
    beyond = (shifted < 0.0) | (shifted >= TAU)
    if beyond.any():
        np.remainder(shifted, TAU, out=shifted, where=beyond)
    shifted -= np.pi
    return shifted


def cos_sin(angle: Array) -> tuple[Array, Array]:
    """Cosine and sine of angles [rad], any shape, both from the tangent of half the angle, piece by piece.

    With t = tan(a/2) they are (1 - t^2)/(1 + t^2) and 2t/(1 + t^2). A relative error e of t turns the angle by e sin a:
    both are good to a few 1e-16 at any angle, in a third of the time that a cosine and a sine take.
    """
    given = np.asarray(angle, dtype=np.float64)
    flat = np.ascontiguousarray(given).reshape(-1)
    cosine, sine = np.empty_like(flat), np.empty_like(flat)
    for start in range(0, flat.size, _PIECE):
        rows = slice(start, start + _PIECE)
        half, tangent = cosine[rows], sine[rows]
        np.multiply(flat[rows], 0.5, out=half)
        np.tan(half, out=tangent)
        scale = np.multiply(tangent, tangent, out=half)
        scale += 1.0
        np.divide(2.0, scale, out=scale)
        tangent *= scale
        scale -= 1.0
    return cosine.reshape(given.shape), sine.reshape(given.shape)


def mean_vector(angle: Array) -> complex:
    """Mean of the unit vectors of angles (n,) [rad], piece by piece; NaN of none."""
    flat, total = np.ravel(angle), 0.0 + 0.0j
    for start in range(0, flat.size, _PIECE):
        cosine, sine = cos_sin(flat[start : start + _PIECE])
        total += complex(cosine.sum(), sine.sum())
    return total / flat.size if flat.size else complex("nan")


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
