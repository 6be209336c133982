"""The best table of a size, found without the program's own fitting: linear and integer programmes on the true curve.

What a drive makes of a reading is linear in the entries of its table. How, is learnt here from the drive's model, one
entry moved at a time, or from straight lines between even nodes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, linprog, milp

from twin.angles import TAU, Array

Made = Callable[[Array], Array]
"""From the entries (n,) of a table to what the drive adds to fixed readings (m,) [deg]."""


def weights_of(made: Made, count: int, step: float) -> Array:
    """By how much what is added to each reading (m,) follows each entry: (m, n), moving one at a time."""
    still = made(np.zeros(count))
    return np.stack([(made(step * (np.arange(count) == k)) - still) / step for k in range(count)], axis=1)


def even_weights(reading_rad: Array, count: int, first: float = 0.0) -> Array:
    """The same of straight lines between so many even nodes, the first so many steps from zero, over the turn's end."""
    place = np.mod(reading_rad / TAU * count - first, count)
    away = np.abs(place[:, None] - np.arange(count))
    return np.maximum(1.0 - np.minimum(away, count - away), 0.0)


def smallest_worst(weights: Array, wanted_deg: Array) -> tuple[float, Array]:
    """The smallest worst error [deg] over readings (m,) that entries of any value leave, and these entries."""
    rows, count = weights.shape
    one = np.ones((rows, 1))
    found = linprog(
        np.append(np.zeros(count), 1.0),
        A_ub=np.block([[weights, -one], [-weights, -one]]),
        b_ub=np.concatenate([wanted_deg, -wanted_deg]),
        bounds=[(None, None)] * count + [(0.0, None)],
    )
    assert found.status == 0
    return float(found.fun), np.asarray(found.x[:-1])


def smallest_worst_of_whole_numbers(weights: Array, wanted_deg: Array, *, seconds: float) -> tuple[float, Array]:
    """A bound from below on the smallest worst error [deg] that whole numbers leave, and whole numbers near to it."""
    rows, count = weights.shape
    one = np.ones((rows, 1))
    low = np.concatenate([np.full(rows, -np.inf), wanted_deg])
    high = np.concatenate([wanted_deg, np.full(rows, np.inf)])
    found = milp(
        np.append(np.zeros(count), 1.0),
        constraints=LinearConstraint(np.block([[weights, -one], [weights, one]]), low, high),
        integrality=np.append(np.ones(count), 0.0),
        bounds=Bounds(np.append(np.full(count, -np.inf), 0.0), np.inf),
        options={"time_limit": seconds, "mip_rel_gap": 0.02},
    )
    assert found.x is not None
    return float(found.mip_dual_bound), np.round(found.x[:-1])


def smallest_worst_of_free_pieces(value_deg: Array, pieces: int) -> tuple[float, Array]:
    """A bound from below on the worst error [deg] of so many joined straight lines through a curve at even steps (m,).

    Lines that need not be joined do no worse: the longest that stays within an error follows the longest before it.
    These lines (m,) come with the bound.
    """
    low, high = 0.0, float(np.ptp(value_deg))
    while high - low > 0.003 * high:
        error = 0.5 * (low + high)
        low, high = (low, error) if _longest(value_deg, error)[0] <= pieces else (error, high)
    return low, _longest(value_deg, high)[1]


def _longest(value: Array, error: float) -> tuple[int, Array]:
    """How many straight lines, longest first, follow the values (m,) within an error, and these lines (m,)."""
    start, count, lines = 0, 0, np.array(value)
    while start < value.size - 1:
        short, long = 1, value.size - 1 - start
        while short < long:
            middle = (short + long + 1) // 2
            within = _of_one_line(value[start : start + middle + 1])[0] <= error
            short, long = (middle, long) if within else (short, middle - 1)
        lines[start : start + short + 1] = _of_one_line(value[start : start + short + 1])[1]
        start, count = start + short, count + 1
    return count, lines


def _of_one_line(value: Array) -> tuple[float, Array]:
    """The worst error of the best straight line through values (m,), half their range about its slope; and the line."""
    at = np.arange(value.size)
    steps = np.diff(value)
    low, high = float(steps.min()), float(steps.max())
    for _ in range(40):
        slopes = low + (high - low) * np.array([1.0, 2.0]) / 3.0
        ranges = np.ptp(value - slopes[:, None] * at, axis=1)
        low, high = (low, float(slopes[1])) if ranges[0] < ranges[1] else (float(slopes[0]), high)
    line = 0.5 * (low + high) * at
    left = value - line
    return 0.5 * float(np.ptp(left)), line + 0.5 * (left.max() + left.min())
