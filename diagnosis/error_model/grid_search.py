"""The paper's ordinary method: try every point of a grid. Feasible on a coarse grid only; the count says why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.error_model import model
from twin.angles import Array

TABLE_2_POINTS = {"Vx": 20001, "Ax": 20001, "Vy": 20001, "Ay": 20001, "Px": 20001, "Magx": 101}
"""Grid points of each factor in Table 2: (max - min)/step + 1."""

_CHUNK = 65536


def full_grid_count() -> int:
    """Points of the grid of Table 2: what the ordinary method would have to try."""
    count = 1
    for points in TABLE_2_POINTS.values():
        count *= points
    return count


@dataclass(frozen=True, eq=False)
class GridResult:
    """The best point (6,) of the grid, its cost, and how many points were tried."""

    best: Array
    cost: float
    evaluations: int


def grid_search(gram: Array, lower: Array, upper: Array, *, points: int) -> GridResult:
    """Every point of a grid of ``points`` a parameter between lower and upper (6,), on a quadratic form (10, 10).

    The grid holds its bounds; with one point a parameter it is the middle. A parameter whose bounds are equal is fixed.
    """
    root = model.factor(gram)
    axes = [
        np.array([0.5 * (low + high)]) if points == 1 or low == high else np.linspace(low, high, points)
        for low, high in zip(lower, upper, strict=True)
    ]
    shape = tuple(axis.size for axis in axes)
    total = int(np.prod(shape))
    best, lowest = np.zeros(6), np.inf
    for start in range(0, total, _CHUNK):
        index = np.unravel_index(np.arange(start, min(start + _CHUNK, total)), shape)
        tried = np.stack([axis[k] for axis, k in zip(axes, index, strict=True)], axis=-1)
        costs = model.cost(model.coefficients(tried), root)
        k = int(np.argmin(costs))
        if costs[k] < lowest:
            best, lowest = tried[k], float(costs[k])
    return GridResult(best, lowest, total)
