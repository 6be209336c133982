"""The motion's least-squares problem: a spline and columns beside it, with the spline eliminated at one penalty."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from diagnosis.spin.spline import PENALISED, Spline, bands
from twin.angles import Array

_BEYOND = np.arange(0.0, 16.0)
"""Common logarithms of penalties that are tried: from one to the next the motion is slower by a third, from a turn to
three hundred of them."""
_WINDOW = 15
"""Third differences over whose mean square the motion's roughness is taken to be even."""
_BEYOND_CHANCE = 4.0
"""A mean of so many squares of one spread exceeds four times its expectation in one of four million."""


@dataclass(frozen=True, eq=False)
class Own:
    """What the log of each reading (n,) has of its own, as it tells it alone.

    How much a reading counts against others by its noise, the frequency below which the motion is freer than the noise
    is loud, and the usual speed. ``largest_rad_s2`` (orders,) are torques that make all that is seen of an order in one
    of the logs.
    """

    precision: Array
    knee_rad_s: Array
    usual_rad_s: Array
    largest_rad_s2: Array


@dataclass(frozen=True, eq=False)
class Problem:
    """Readings (n,) [rad] about a start, on the splines, and columns (p, n) beside them.

    ``precision`` (n,) is how much a reading counts against others, ``weights`` (n,) the same with 0 for readings that
    are left out, ``stiffness`` (d,) that of each difference of the spline.
    """

    spline: Spline
    readings: Array
    time_s: Array
    precision: Array
    weights: Array
    stiffness: Array
    start: Array
    columns: Array
    damping_per_s: float = 0.0

    @cached_property
    def rough(self) -> Any:
        """Matrix (d, k) of how much the torque changes from knot to knot: third differences, and damped second ones."""
        held_back = self.damping_per_s * self.spline.step_s
        return self.spline.rough + self.spline.bent.multiply(held_back[:, None]).tocsr()

    @cached_property
    def _of_readings(self) -> tuple[Array, Array, Array, Array, Array, float]:
        """What the readings make of the normal equations, whatever the penalty.

        Bands, across, left, its product, the columns' own, and the squares of what is left.
        """
        design = self.spline.design
        away = self.readings - design @ self.start
        left = self.weights * away
        weighed = self.weights * self.columns
        across = np.asarray(design.T @ weighed.T)
        own = weighed @ self.columns.T
        return bands(design, self.weights), across, left, design.T @ left, own, float(left @ away)

    @cached_property
    def _of_differences(self) -> tuple[Array, Array]:
        """The same of the differences that are held, for a penalty of 1: bands, and the differences themselves."""
        return bands(self.rough, self.stiffness), self.rough @ self.start

    def holding(self, stiffness: Array, damping_per_s: float) -> Problem:
        """The same with the motion held otherwise."""
        held = replace(self, stiffness=stiffness, damping_per_s=damping_per_s)
        # What the readings make of it does not change, and takes the most of the time.
        held.__dict__["_of_readings"] = self._of_readings
        return held

    def reduced(self, log_penalty: float, *, ridge: float = 1e-12) -> Reduced:
        """The problem with the spline eliminated, at one penalty."""
        from scipy.linalg import cho_solve_banded

        _, across, left, along, own, squares = self._of_readings
        differences = self._of_differences[1]
        held = 10.0**log_penalty * self.stiffness * differences
        factor = self._factor(log_penalty, ridge)
        rhs = along - self.rough.T @ held
        solved = cho_solve_banded((factor, True), np.column_stack([rhs, across]))
        step, pulled = solved[:, 0], solved[:, 1:]
        normal = own - across.T @ pulled
        gradient = self.columns @ left - across.T @ step
        squares += float(held @ differences - rhs @ step)
        log_det = 2.0 * float(np.sum(np.log(factor[0]))) - len(held) * log_penalty * float(np.log(10.0))
        # A motion is told forward from how it begins: of each knot by its predecessors, as the torque has changed.
        log_det -= 2.0 * float(np.sum(np.log1p(0.5 * self.damping_per_s * self.spline.step_s)))
        log_det -= float(np.sum(np.log(self.stiffness)))
        return Reduced(normal, gradient, squares, log_det, step, pulled)

    def _factor(self, log_penalty: float, ridge: float) -> Array:
        """Cholesky's factor (4, k) of the spline's normal matrix."""
        from scipy.linalg import cholesky_banded

        system = self._of_readings[0] + 10.0**log_penalty * self._of_differences[0]
        # Of a knot interval without a reading in use the differences alone tell the coefficients, and not all of them.
        system[0] += ridge * np.max(system[0])
        return np.asarray(cholesky_banded(system, lower=True))

    def projection(self, log_penalty: float, *, ridge: float = 1e-12) -> Projection:
        """What a column beside the spline is once that has taken what it can of it."""
        reduced = self.reduced(log_penalty, ridge=ridge)
        left = self.weights * (self.readings - self.spline.design @ (self.start + reduced.step))
        return Projection(self, self._factor(log_penalty, ridge), np.asarray(left), reduced.squares)


@dataclass(frozen=True, eq=False)
class Projection:
    """Columns (m, n) less what the spline takes of them, weighed: so that products with columns are normal equations.

    ``left`` (n,) is the same of the readings, and ``squares`` what of theirs is left.
    """

    problem: Problem
    factor: Array
    left: Array
    squares: float

    def of(self, columns: Array) -> Array:
        """Of columns (m, n)."""
        from scipy.linalg import cho_solve_banded

        design, weights = self.problem.spline.design, self.problem.weights
        weighed = weights * columns
        pulled = cho_solve_banded((self.factor, True), np.asarray(design.T @ weighed.T))
        return np.asarray(weighed - weights * np.asarray(design @ pulled).T)


@dataclass(frozen=True, eq=False)
class Reduced:
    """What is left for the columns once the spline has taken what it can."""

    normal: Array
    gradient: Array
    squares: float
    log_det: float
    step: Array
    pulled: Array

    def left(self, sd: Array, variance: float) -> tuple[float, float]:
        """Squares that the columns leave where they scatter by ``sd`` (p,), and the log determinant of their system."""
        system = self.normal + np.diag(variance / sd**2)
        scale = 1.0 / np.sqrt(np.maximum(np.diag(system), 1e-300))
        system = system * np.outer(scale, scale) + 1e-12 * np.eye(len(scale))
        along = self.gradient * scale
        _, log_det = np.linalg.slogdet(system)
        left = self.squares - float(along @ np.linalg.solve(system, along))
        return left, float(log_det) - 2.0 * float(np.sum(np.log(scale)))

    def cost(self, sd: Array, variance: float, rows: float) -> float:
        """Minus twice the restricted log likelihood of a penalty, the noise's variance at its best."""
        left, log_det = self.left(sd, variance)
        return rows * float(np.log(max(left, 1e-300))) + self.log_det + log_det


def evened(stiffness: Array, differences: Array) -> Array:
    """This stiffness (d,), less where differences (d,) of the motion show it to be rougher than is usual."""
    from scipy.ndimage import uniform_filter1d

    local = uniform_filter1d(stiffness * differences**2, _WINDOW, mode="nearest")
    usual = _BEYOND_CHANCE * max(float(np.median(local)), 1e-300)
    return np.asarray(stiffness / np.maximum(local / usual, 1.0))


def degrees_of_freedom(problem: Problem, sd: Array) -> float:
    """Readings in use less what is free: the splines' parabola, and the columns that do not scatter."""
    return float(np.count_nonzero(problem.weights)) - PENALISED - int(np.count_nonzero(~np.isfinite(sd)))


def knee(problem: Problem, log_penalty: float) -> Array:
    """Angular frequency (n,) [rad/s] at which the spline takes half of what a reading's noise does."""
    spline = problem.spline
    step = float(np.median(np.diff(problem.time_s)))
    held = 10.0**log_penalty * np.interp(problem.time_s, spline.at_s, problem.stiffness)
    return np.asarray(
        (problem.precision * spline.spacing_s / (held * step)) ** (1.0 / (2 * PENALISED)) / spline.spacing_s
    )


def held_at(problem: Problem, knee_rad_s: Array) -> Array:
    """Stiffness (d,) with which the spline takes half of what a reading's noise does at these frequencies (n,)."""
    spline = problem.spline
    step = float(np.median(np.diff(problem.time_s)))
    held = problem.precision * spline.spacing_s / (step * (knee_rad_s * spline.spacing_s) ** (2 * PENALISED))
    return np.asarray(np.interp(spline.at_s, problem.time_s, held))


def likeliest(
    problem: Problem, sd: Array, variance: float, *, around: float | None, turning_rad_s: Array | float
) -> tuple[float, float]:
    """The penalty (its common logarithm) and the noise's variance of highest restricted likelihood.

    A wave in time, as of the mains in a channel, makes another peak of it, of a motion so free that it holds the wave
    and all that is slower. Of a motion freer than the usual turn no order of the sensor's would be told: none is taken
    to be so free, and a peak within that is taken before its edge. Which peak, is looked for where there is none to
    look ``around``.
    """
    from scipy.optimize import minimize_scalar

    rows = degrees_of_freedom(problem, sd)

    def cost(log_penalty: float) -> float:
        return problem.reduced(log_penalty).cost(sd, variance, rows)

    least = 2.0 * PENALISED * float(np.log10(np.median(knee(problem, 0.0) / turning_rad_s)))
    if around is None:
        tried = least + _BEYOND
        costs = np.array([cost(one) for one in tried])
        peaks = np.flatnonzero((costs[1:-1] <= costs[:-2]) & (costs[1:-1] <= costs[2:])) + 1
        among = peaks if peaks.size else np.arange(costs.size)
        around = float(tried[among[np.argmin(costs[among])]])
    bounds = (max(around - 1.0, least), max(around, least) + 1.0)
    best = float(minimize_scalar(cost, bounds=bounds, method="bounded", options={"xatol": 0.05}).x)
    return best, max(problem.reduced(best).left(sd, variance)[0] / rows, 1e-24)
