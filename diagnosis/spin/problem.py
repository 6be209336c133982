"""The motion's least-squares problem: a spline and columns beside it, with the spline eliminated at one penalty."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from diagnosis.spin.spline import PENALISED, Spline
from twin.angles import Array


@dataclass(frozen=True, eq=False)
class Problem:
    """Readings (n,) [rad] about a start, on the splines; the present stiffness of each difference (d,)."""

    spline: Spline
    readings: Array
    time_s: Array
    weights: Array
    stiffness: Array
    start: Array
    columns: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def reduced(self, log_penalty: float) -> Reduced:
        """The problem with the spline eliminated, at one penalty."""
        from scipy.linalg import cho_solve_banded, cholesky_banded

        held = 10.0**log_penalty * self.stiffness
        bands = self.spline.bands(self.weights, held)
        # Of a knot interval without a reading in use the differences alone tell the coefficients, and not all of them.
        bands[0] += 1e-12 * np.max(bands[0])
        factor = cholesky_banded(bands, lower=True)
        design, rough = self.spline.design, self.spline.rough
        left = self.weights * (self.readings - design @ self.start)
        differences = rough @ self.start
        rhs = design.T @ left - rough.T @ (held * differences)
        across = np.asarray(design.T @ (self.weights * self.columns).T)
        solved = cho_solve_banded((factor, True), np.column_stack([rhs, across]))
        step, pulled = solved[:, 0], solved[:, 1:]
        normal = (self.weights * self.columns) @ self.columns.T - across.T @ pulled
        gradient = self.columns @ left - across.T @ step
        squares = float(left @ (self.readings - design @ self.start) + held @ differences**2 - rhs @ step)
        log_det = 2.0 * float(np.sum(np.log(factor[0]))) - len(held) * log_penalty * float(np.log(10.0))
        return Reduced(normal, gradient, squares, log_det, step, pulled)


@dataclass(frozen=True, eq=False)
class Reduced:
    """What is left for the columns once the spline has taken what it can."""

    normal: Array
    gradient: Array
    squares: float
    log_det: float
    step: Array
    pulled: Array

    def cost(self, sd: Array, variance: float, rows: float) -> float:
        """Minus twice the restricted log likelihood, the noise's variance at its best."""
        system = self.normal + np.diag(variance / sd**2)
        scale = 1.0 / np.sqrt(np.maximum(np.diag(system), 1e-300))
        system = system * np.outer(scale, scale) + 1e-12 * np.eye(len(scale))
        _, log_det = np.linalg.slogdet(system)
        along = self.gradient * scale
        left = self.squares - float(along @ np.linalg.solve(system, along))
        return (
            rows * float(np.log(max(left, 1e-300))) + self.log_det + float(log_det) - 2.0 * float(np.sum(np.log(scale)))
        )


def solution(problem: Problem, log_penalty: float) -> Array:
    """The spline alone, at one penalty."""
    from scipy.linalg import solveh_banded

    held = 10.0**log_penalty * problem.stiffness
    bands = problem.spline.bands(problem.weights, held)
    rhs = problem.spline.design.T @ (problem.weights * problem.readings)
    return np.asarray(solveh_banded(bands, rhs, lower=True))


def likeliest(problem: Problem, sd: Array, variance: float, *, around: float | None) -> tuple[float, float]:
    """The penalty (its common logarithm) and the noise's variance of highest restricted likelihood."""
    from scipy.optimize import minimize_scalar

    free = int(np.count_nonzero(~np.isfinite(sd)))
    rows = float(problem.weights.sum()) - PENALISED - free

    def cost(log_penalty: float) -> float:
        return problem.reduced(log_penalty).cost(sd[: len(problem.columns)], variance, rows)

    low, high = (-10.0, 14.0) if around is None else (around - 3.0, around + 3.0)
    best = float(minimize_scalar(cost, bounds=(low, high), method="bounded", options={"xatol": 0.05}).x)
    reduced = problem.reduced(best)
    system = reduced.normal + np.diag(variance / sd[: len(problem.columns)] ** 2)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(system), 1e-300))
    along = reduced.gradient * scale
    taken = along @ np.linalg.solve(system * np.outer(scale, scale) + 1e-12 * np.eye(len(scale)), along)
    return best, max((reduced.squares - float(taken)) / rows, 1e-24)
