"""Levenberg-Marquardt for many sweeps at once, on the Gram matrix or on the exact angle residual."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import model
from diagnosis.error_model.model import LOWER_LIMIT, UPPER_LIMIT, Readings
from twin.angles import Array

Normal = Callable[[Array], tuple[Array, Array, Array]]
"""Points (batch, 6) -> curvature J^T W J (batch, 6, 6), descent J^T W e (batch, 6), sum of squares (batch,)."""

_LONGEST = 200
_SETTLED = 1e-10
"""A step is the last one where it is shorter than 1e-5 standard errors, squared here."""
_ROUNDING = 1e-28
"""Sum of squares a reading below which a residual is rounding, [rad^2]."""


class Minimum(NamedTuple):
    """Where the descent ended."""

    points: Array
    """(batch, 6)"""
    cost: Array
    """Weighted sum of squares (batch,)."""
    curvature: Array
    """J^T W J there (batch, 6, 6)."""
    passes: int
    """Evaluations of the sums."""
    settled: NDArray[np.bool_]
    """(batch,)"""


def on_gram(gram: Array) -> Normal:
    """The sums of the quadratic form (batch, 10, 10): no pass over the readings."""

    def sums(points: Array) -> tuple[Array, Array, Array]:
        coefs = model.coefficients(points)
        slopes = model.coefficient_slopes(points)
        pulled = gram @ coefs[..., None]
        back = np.swapaxes(slopes, -1, -2)
        total = np.maximum((coefs[..., None, :] @ pulled)[..., 0, 0], 0.0)
        return back @ gram @ slopes, -(back @ pulled)[..., 0], total

    return sums


def on_readings(readings: Readings) -> Normal:
    """The sums of the exact angle residual, one pass over readings (batch, n)."""

    def sums(points: Array) -> tuple[Array, Array, Array]:
        batch = points.shape[0]
        curvature, descent, total = np.zeros((batch, 6, 6)), np.zeros((batch, 6)), np.zeros(batch)
        for _, part in readings.chunks():
            residual, slopes = part.linearised(points)
            pulled = slopes if part.weights is None else slopes * part.weights[..., None, :]
            curvature += pulled @ np.swapaxes(slopes, -1, -2)
            descent += (pulled @ residual[..., None])[..., 0]
            squares = residual * residual if part.weights is None else residual * residual * part.weights
            total += squares.sum(axis=-1)
        return curvature, descent, total

    return sums


def descend_on_gram(gram: Array, start: Array, *, count: int) -> Minimum:
    """Descend on quadratic forms (batch, 10, 10) as far as their digits go, see :func:`descend`."""
    return descend(on_gram(gram), start, count=count, rounding=rounding_of(gram))


def rounding_of(gram: Array) -> Array:
    """By how much the sum of squares of a quadratic form (batch, 10, 10) is rounded, (batch,): a sum of such terms."""
    return np.asarray(np.finfo(np.float64).eps * np.trace(gram, axis1=-2, axis2=-1))


def descend(
    normal: Normal,
    start: Array,
    *,
    count: int,
    fixed: NDArray[np.bool_] | None = None,
    rounding: Array | float = 0.0,
) -> Minimum:
    """Descend from ``start`` (batch, 6) within the twin's limits; ``count`` is the number of readings a sweep.

    Parameters marked in ``fixed`` (6,) stay where they start. A step that gains less than ``rounding``, one or
    (batch,), is the last.
    """
    points = np.clip(start, LOWER_LIMIT, UPPER_LIMIT)
    curvature, descent, total = normal(points)
    damping = np.full(total.shape, 1e-6)
    settled = total <= _ROUNDING * count
    passes = 1
    while passes < _LONGEST and not settled.all():
        held = _held(points, descent)
        step = _solve(curvature, descent, damping, held if fixed is None else held | fixed)
        trial = np.clip(points + step, LOWER_LIMIT, UPPER_LIMIT)
        expected = np.einsum("bi,bij,bj->b", step, curvature, step)
        settled |= expected <= np.maximum(_SETTLED * total / max(count - 6, 1), rounding)
        if settled.all():
            # The last step is taken unseen: it is shorter than any error bar, and costs no pass.
            points = np.where(settled[:, None], trial, points)
            break
        new_curvature, new_descent, new_total = normal(trial)
        passes += 1
        better = ~settled & (new_total <= total)
        settled |= better & ((new_total <= _ROUNDING * count) | (total - new_total <= 1e-14 * total))
        points = np.where(better[:, None], trial, points)
        curvature = np.where(better[:, None, None], new_curvature, curvature)
        descent = np.where(better[:, None], new_descent, descent)
        total = np.where(better, new_total, total)
        damping = np.clip(np.where(better, 0.1 * damping, 10.0 * damping), 1e-14, 1e12)
        settled |= damping >= 1e12
    return Minimum(points, total, curvature, passes, settled)


def _held(points: Array, descent: Array) -> NDArray[np.bool_]:
    """Parameters (batch, 6) that stand at a limit and would be pushed beyond it."""
    return ((points <= LOWER_LIMIT) & (descent < 0)) | ((points >= UPPER_LIMIT) & (descent > 0))


def _solve(curvature: Array, descent: Array, damping: Array, held: NDArray[np.bool_]) -> Array:
    """The damped step (batch, 6), scaled by the diagonal so that units do not matter."""
    diagonal = np.maximum(np.einsum("bii->bi", curvature), 1e-300)
    scale = np.where(held, 0.0, 1.0 / np.sqrt(diagonal))
    scaled = curvature * scale[:, :, None] * scale[:, None, :]
    # A parameter held at its limit gets a unit row; 1e-13 keeps a design that cannot see a combination solvable.
    scaled += np.eye(6) * (damping + 1e-13)[:, None, None] + np.einsum("ij,bj->bij", np.eye(6), held * 1.0)
    return np.asarray(scale * np.linalg.solve(scaled, (scale * descent)[..., None])[..., 0])
