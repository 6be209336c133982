"""Intervals by the profile likelihood: right also where a straight line does not describe a parameter's effect."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.error_model import least_squares, model
from diagnosis.error_model.model import NAMES
from diagnosis.error_model.result import BaselineFit
from twin.angles import Array
from twin.confidence import student_95

_POINTS = 81
"""Values at which the profile is computed, an odd number: the fitted value is the middle one."""
_REACH = 8.0
"""How far they reach to each side, in standard errors."""


@dataclass(frozen=True)
class Profile:
    """95 % limits of one parameter by its profile likelihood; infinite where that never falls far enough."""

    name: str
    low: float
    high: float


def profile(fit: BaselineFit, gram: Array, index: int) -> Profile:
    """Limits of the parameter at place ``index``: least squares over the other five at fixed values of it.

    ``gram`` (10, 10) is the quadratic form of the readings, so no pass over them is needed.
    """
    error = fit.standard_errors[index]
    offsets = np.linspace(-_REACH, _REACH, _POINTS) * error
    start = np.tile(fit.point, (_POINTS, 1))
    start[:, index] += offsets
    start = np.clip(start, model.LOWER_LIMIT, model.UPPER_LIMIT)
    fixed = np.arange(6) == index
    lanes = np.broadcast_to(gram, (_POINTS, 10, 10))
    count = fit.residual_rad.size
    found = least_squares.descend(least_squares.on_gram(lanes), start, count=count, fixed=fixed)
    middle = _POINTS // 2
    # The covariance may count angles instead of readings: its variance of a reading sets the scale.
    curvature = least_squares.on_gram(gram[None])(fit.point[None]).curvature
    variance = float(np.mean(np.diagonal(fit.covariance @ curvature[0])))
    rise = (found.cost - found.cost[middle]) / max(variance, 1e-300)
    limit = student_95(max(fit.degrees_of_freedom, 1)) ** 2
    low = _crossing(start[middle::-1, index], rise[middle::-1], limit)
    high = _crossing(start[middle:, index], rise[middle:], limit)
    return Profile(NAMES[index], low if low is not None else -np.inf, high if high is not None else np.inf)


def _crossing(values: Array, rise: Array, limit: float) -> float | None:
    """Value at which the rise (n,), from 0 on, first reaches the limit; None where it does not."""
    above = np.flatnonzero(rise >= limit)
    if not above.size:
        return None
    k = int(above[0])
    # The rise is nearly a parabola, so its root is nearly straight.
    a, b = np.sqrt(np.maximum(rise[k - 1], 0.0)), np.sqrt(rise[k])
    return float(values[k - 1] + (values[k] - values[k - 1]) * (np.sqrt(limit) - a) / max(b - a, 1e-300))
