"""Levenberg-Marquardt for many sweeps at once, on the Gram matrix or on the exact angle residual."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import model, moments
from diagnosis.error_model.model import LOWER_LIMIT, UPPER_LIMIT, Readings
from twin.angles import Array


class Sums(NamedTuple):
    """What a pass over the readings tells at points (batch, 6)."""

    curvature: Array
    """J^T W J (batch, 6, 6)."""
    descent: Array
    """J^T W e (batch, 6)."""
    cost: Array
    """Weighted sum of squares (batch,)."""
    residual: Array
    """e (batch, n) [rad]; of a quadratic form (batch, 0)."""

    def where(self, better: NDArray[np.bool_], other: Sums) -> Sums:
        """These, and the others of the sweeps (batch,) that are not better."""
        if better.all():
            return self
        pairs = zip(self, other, strict=True)
        return Sums(*(np.where(better.reshape(-1, *(1,) * (one.ndim - 1)), one, two) for one, two in pairs))


class Normal(Protocol):
    """The sums at points (batch, 6), with the curvature (batch, 6, 6) that is known where it need not be summed."""

    def __call__(self, points: Array, known: Array | None = None, /) -> Sums: ...


_X_AND_Y: Array = np.array([[-1.0], [1.0]])
_ALIKE = 1e-6
"""A step of less, in fractions of the amplitude and radians, changes the curvature by some 1e-6 of it: it is kept."""
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
    residual: Array
    """h m - atan2(y, x) there (batch, n) [rad]; of a quadratic form (batch, 0)."""


def on_gram(gram: Array) -> Normal:
    """The sums of the quadratic form (batch, 10, 10): no pass over the readings."""

    def sums(points: Array, known: Array | None = None) -> Sums:
        coefs = model.coefficients(points)
        slopes = model.coefficient_slopes(points)
        pulled = gram @ coefs[..., None]
        back = np.swapaxes(slopes, -1, -2)
        total = np.maximum((coefs[..., None, :] @ pulled)[..., 0, 0], 0.0)
        return Sums(back @ gram @ slopes, -(back @ pulled)[..., 0], total, np.empty((*total.shape, 0)))

    return sums


def on_readings(readings: Readings) -> Normal:
    """The sums of the exact angle residual, one pass over readings (batch, n)."""

    def sums(points: Array, known: Array | None = None) -> Sums:
        batch = points.shape[0]
        # Of the coefficients the first five make y, the others -x: here in the order x, y.
        channels = model.coefficients(points).reshape(batch, 2, moments.SHAFT)[:, ::-1] * _X_AND_Y
        full = known is None
        sums = moments.Moments(
            (batch,),
            readings.longest,
            rows=5 if full else 2,
            harmonics=moments.HARMONICS if full else moments.SHAFT,
        )
        cost, residual = np.zeros(batch), np.empty((batch, readings.count))
        for rows, part in readings.chunks():
            harmonics, each = sums.piece(part.cos_shaft, part.sin_shaft)
            pair = channels @ harmonics[:, : moments.SHAFT]
            left, radius2 = _residual(part, pair, residual[:, rows])
            pulled = left if part.weights is None else left * part.weights
            pair /= radius2[:, None]
            np.multiply(pair, pulled[:, None], out=each[:, :2])
            if full:
                moments.products(pair[:, 0], pair[:, 1], part.weights, each[:, 2:])
            sums.add(harmonics, each)
            cost += (left[:, None] @ pulled[..., None])[:, 0, 0]
        # With u, v = (x, y) / r^2 the slopes of atan2(y, x) are u dy - v dx: those of the form in the features of u, v.
        slopes = model.coefficient_slopes(points)
        back = np.swapaxes(slopes, -1, -2)
        pull = np.swapaxes(sums.total[:, : moments.SHAFT, :2], -1, -2).reshape(batch, 2 * moments.SHAFT, 1)
        curvature = back @ moments.gram(sums.total[..., 2:]) @ slopes if known is None else known
        return Sums(curvature, (back @ pull)[..., 0], cost, residual)

    return sums


def _residual(part: Readings, pair: Array, out: Array) -> tuple[Array, Array]:
    """h m - atan2(y, x) (batch, n) [rad], written to ``out``, and r^2 (batch, n) of x and y (batch, 2, n)."""
    x, y = pair[:, 0], pair[:, 1]
    sine, cosine = x * part.sin_read, x * part.cos_read
    other = y * part.cos_read
    sine -= other
    cosine += np.multiply(y, part.sin_read, out=other)
    np.arctan2(sine, cosine, out=out)
    radius2 = np.multiply(x, x, out=sine)
    radius2 += np.multiply(y, y, out=cosine)
    return out, radius2


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
    here = normal(points)
    damping = np.full(here.cost.shape, 1e-6)
    settled = here.cost <= _ROUNDING * count
    passes = 1
    while passes < _LONGEST and not settled.all():
        held = _held(points, here.descent)
        step = _solve(here.curvature, here.descent, damping, held if fixed is None else held | fixed)
        trial = np.clip(points + step, LOWER_LIMIT, UPPER_LIMIT)
        expected = np.einsum("bi,bij,bj->b", step, here.curvature, step)
        settled |= expected <= np.maximum(_SETTLED * here.cost / max(count - 6, 1), rounding)
        if settled.all():
            if not here.residual.size:
                # The last step is taken unseen: it is shorter than any error bar, and costs no pass.
                points = np.where(settled[:, None], trial, points)
            break
        there = normal(trial, here.curvature if np.all(np.abs(step) < _ALIKE) else None)
        passes += 1
        better = ~settled & (there.cost <= here.cost)
        settled |= better & ((there.cost <= _ROUNDING * count) | (here.cost - there.cost <= 1e-14 * here.cost))
        points = np.where(better[:, None], trial, points)
        here = there.where(better, here)
        damping = np.clip(np.where(better, 0.1 * damping, 10.0 * damping), 1e-14, 1e12)
        settled |= damping >= 1e12
    return Minimum(points, here.cost, here.curvature, passes, settled, here.residual)


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
