"""The range that the swarm searches: that of Table 2, widened where the best particle stands at its edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model.model import GAIN, LOWER_LIMIT, UPPER_LIMIT, ZERO
from twin.angles import Array

TABLE_2_HALF: Array = np.array([0.01 / 0.99, 0.01 / 0.99, 1.01 / 0.99 - 1.0, np.radians(0.9), 0.003, np.radians(2.0)])
"""Half widths (6,) of Table 2 in the visible parameters.

Vx/Ax, Vy/Ay and Ay/Ax follow from the ranges of the four; beta is read as 0.9 deg (printed 0.9/pi); 50 to 150 mT of
q = 1.896e-5/mT end below 0.003; the zero, which Table 2 lacks, lies this near the mean angle error.
"""

_STEP = 4.0
_NEAR = 0.02
_FARTHEST_ZERO = np.pi


@dataclass(frozen=True, eq=False)
class Box:
    """Search ranges, one a lane: lower, upper, half width, whether widened (lanes, 6); middle of the zero (lanes,)."""

    lower: Array
    upper: Array
    half: Array
    widened: NDArray[np.bool_]
    zero: Array


def first_box(zero: Array) -> Box:
    """The range of Table 2 around these zeros (lanes,)."""
    half = np.tile(TABLE_2_HALF, (zero.size, 1))
    return _box(half, np.zeros(half.shape, dtype=bool), zero)


def at_wall(best: Array, lower: Array, upper: Array) -> NDArray[np.bool_]:
    """Which coordinates (lanes, 6) of the best particles stand at an edge that can still be moved."""
    margin = _NEAR * (upper - lower)
    low = (best - lower <= margin) & (lower > LOWER_LIMIT)
    high = (upper - best <= margin) & (upper < UPPER_LIMIT)
    open_zero = upper - lower < 2.0 * _FARTHEST_ZERO
    open_zero[:, :ZERO] = True
    return (low | high) & open_zero


def widened(box: Box, walls: NDArray[np.bool_]) -> Box:
    """The ranges with the marked edges (lanes, 6) moved outwards."""
    return _box(np.where(walls, _STEP * box.half, box.half), box.widened | walls, box.zero)


def _box(half: Array, wide: NDArray[np.bool_], zero: Array) -> Box:
    lower, upper = -half, half.copy()
    # A ratio is as likely too small as too large by the same factor.
    upper[:, GAIN] = 1.0 + half[:, GAIN]
    lower[:, GAIN] = 1.0 / upper[:, GAIN]
    reach = np.minimum(half[:, ZERO], _FARTHEST_ZERO)
    lower[:, ZERO], upper[:, ZERO] = zero - reach, zero + reach
    return Box(np.maximum(lower, LOWER_LIMIT), np.minimum(upper, UPPER_LIMIT), half, wide, zero)
