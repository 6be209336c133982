"""How fast friction and the drive undo a departure of the shaft from its speed, told by the smooth motion itself.

What a torque locked to the angle does to the shaft follows the same rate, and of that two speeds tell nothing: an order
has two coefficients at each of them, the sensor's error and the torque as many. The motion tells it: from one speed to
the next it goes as exp(-rate t), and a coast slows by friction that falls with the speed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from diagnosis.spin.problem import Problem, degrees_of_freedom, evened
from diagnosis.spin.spline import PENALISED
from twin.angles import Array

_TRIED = np.linspace(0.0, 1.0, 13)
"""Roots of rates against the fastest that is looked for: rates are as likely small as large."""
_DEVIATIONS = 2.0
"""Of a sum of as many squares: what noise exceeds once in forty times."""
_SURELY = 2.0 * float(np.log(1000.0))
"""Twice the logarithm of a thousand to one: so much likelier what would change all else has to be than none of it."""
_RIDGE = 1e-14
"""Share of the largest element that is added to all: more would hold a motion that is even, most of all undamped."""
_PENALTIES = 6.0
"""Powers of ten to either side of the penalty as it stands: it holds torques, which a higher rate makes larger."""


def damping(
    problem: Problem, terms: Array, stiffness: Array, *, log_penalty: float, variance: float, fastest_per_s: float
) -> tuple[float, float]:
    """The rate [1/s] of highest restricted likelihood, and its standard deviation.

    Parameters
    ----------
    problem : Problem
        Readings, and columns (p, n) beside the motion with their coefficients ``terms`` (p,), which stay as they are.
    stiffness : ndarray
        Of each difference (d,) before rougher motion is held less: how much less, follows from the rate.
    log_penalty, variance : float
        Common logarithm of the penalty, about, and the variance [rad^2] of a reading's noise.
    fastest_per_s : float
        The highest rate that is looked for.
    """
    from scipy.optimize import minimize_scalar

    bare = replace(problem, readings=problem.readings - terms @ problem.columns, columns=problem.columns[:0])
    rows, none = degrees_of_freedom(bare, np.zeros(0)), np.zeros(0)
    around = (log_penalty - _PENALTIES, log_penalty + _PENALTIES)
    pilot = _pilot(bare.holding(stiffness, 0.0), variance, around)

    def cost(root: float) -> float:
        even = bare.holding(stiffness, root**2 * fastest_per_s)
        held = bare.holding(evened(stiffness, even.rough @ pilot), even.damping_per_s)
        found = minimize_scalar(
            lambda one: held.reduced(one, ridge=_RIDGE).cost(none, 1.0, rows),
            bounds=around,
            method="bounded",
            options={"xatol": 0.1},
        )
        return float(found.fun) - _of_ways(bare, even.damping_per_s)

    costs = np.array([cost(root) for root in _TRIED])
    place, step = int(np.argmin(costs)), float(_TRIED[1])
    bounds = (max(_TRIED[place] - step, 0.0), min(_TRIED[place] + step, 1.0))
    best = minimize_scalar(cost, bounds=bounds, method="bounded", options={"xatol": 0.002})
    lowest, root = min((float(best.fun), float(best.x)), (float(costs[place]), float(_TRIED[place])))
    if costs[0] - lowest < _SURELY:
        return 0.0, 0.0
    return root**2 * fastest_per_s, _deviation(cost, root, lowest) * fastest_per_s


def _of_ways(bare: Problem, damping_per_s: float) -> float:
    """Log determinant of the ways in which a shaft goes on without a torque that changes, as the readings see them.

    Restricted likelihoods compare rates only beside it, as these ways (standstill, an even speed, one that dies away)
    depend on the rate (D. A. Harville, Biometrika 61 (1974) 383): a way that is small would be likelier by being so.
    """
    spline, total = bare.spline, 0.0
    ends = np.cumsum([0, *spline.sizes])
    for first, last in pairwise(ends):
        step = float(spline.step_s[first - PENALISED * int(np.searchsorted(ends, first))])
        kept = (1.0 - 0.5 * damping_per_s * step) / (1.0 + 0.5 * damping_per_s * step)
        knot = np.arange(last - first, dtype=np.float64)
        dies = np.concatenate([[0.0, 0.0], np.cumsum(np.cumsum(kept ** knot[:-2]))])
        seen = np.sqrt(bare.weights)[:, None] * (
            spline.design[:, first:last] @ np.stack([np.ones_like(knot), knot, dies]).T
        )
        scale = np.linalg.norm(seen, axis=0)
        total += float(np.linalg.slogdet((seen / scale).T @ (seen / scale))[1]) + 2.0 * float(np.sum(np.log(scale)))
    return total


def _pilot(even: Problem, variance: float, around: tuple[float, float]) -> Array:
    """The stiffest even motion (k,) that leaves no more than noise of this variance: it is rough where there is a jerk.

    A freer one is as rough everywhere by its noise alone, a stiffer one spreads the jerk to where there is none.
    """
    from scipy.optimize import brentq

    rows = float(np.count_nonzero(even.weights))
    most = variance * (rows + _DEVIATIONS * float(np.sqrt(2.0 * rows)))

    def moved(one: float) -> Array:
        return np.asarray(even.start + even.reduced(one).step)

    def too_much(one: float) -> float:
        left = even.readings - even.spline.design @ moved(one)
        return float(even.weights @ left**2) - most

    if too_much(around[1]) < 0.0:
        return moved(around[1])
    if too_much(around[0]) > 0.0:
        return moved(around[0])
    return moved(float(brentq(too_much, *around, xtol=0.1)))


def _deviation(cost: Callable[[float], float], root: float, least: float) -> float:
    """Standard deviation of a root's square, by how the deviance rises on both sides of the least."""
    away = _TRIED[1] / 64.0
    while away < _TRIED[-1]:
        ends = np.clip([root - away, root + away], 0.0, _TRIED[-1])
        risen = np.array([cost(float(end)) for end in ends[ends != root]]) - least
        squares = np.abs(ends[ends != root] ** 2 - root**2)
        if np.max(risen) > 1.0:
            return float(np.mean(squares / np.sqrt(np.maximum(risen, 0.25))))
        away *= 2.0
    return float(_TRIED[-1])
