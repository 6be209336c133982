"""What readings say of the terms of the laws: information, noise and its colour, scatter that no law explains.

Everything here is algebra on the normal equations at the fit of the fullest laws, in which each factor has every
power that the levels support: a smaller model is the same sum of squares with some coefficients held at 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.thermal.levels import Levels
from diagnosis.thermal.sums import Beside, Mask, Model, sums
from twin.angles import Array, wrap

FAMILY_LEVEL = 0.01
"""Probability that of a sensor without any drift a factor is called sensitive, and of a false immune one likewise."""
_UNSEEN = 1e-9
_SMALLEST = 1e-20
_MOST_CORRELATED = 0.97
_TURNS = 20
_SURELY = 3.0
"""Standard errors from which neighbours are taken to go together."""
_OF_ITS_OWN = 1e-3
"""Share of its information that a column of a level keeps beside the laws; less is a law's, seen through jitter."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """Normal equations of the terms at ``coefficients`` (6, powers), whose mask is ``terms``, and their noise.

    ``information`` (p, p) and ``pull`` (p,) are those of the terms once everything beside them is fitted.
    ``widening`` (6,): variance of each factor over that of independent readings about the laws. ``freedom`` (6,):
    degrees of freedom of that variance.
    """

    terms: Mask
    coefficients: Array
    information: Array
    pull: Array
    variance: float
    widening: Array
    freedom: Array
    scatters: Mask
    """Factors (6,) whose levels stand farther from any law than the noise allows."""

    def solve(self, mask: Mask) -> tuple[Array, Array]:
        """Coefficients (6, powers) of the model with the terms of the mask alone, and their covariance (p, p).

        The covariance is in the order of the mask's terms.
        """
        inside = mask[self.terms]
        held = -self.coefficients[self.terms][~inside]
        curvature = self.information[np.ix_(inside, inside)]
        inverse = _inverse(curvature)
        step = inverse @ (self.pull[inside] - self.information[np.ix_(inside, ~inside)] @ held)
        found = np.where(mask, self.coefficients, 0.0)
        found[mask] += step
        root = np.sqrt(self.widening[np.argwhere(mask)[:, 0]])
        values, vectors = np.linalg.eigh(curvature)
        half = inverse @ (root[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))
        return found, np.asarray(self.variance * half @ half.T)

    def rise(self, mask: Mask, factor: int, power: int) -> float:
        """p-value of the terms that raise a factor's law to a power, given the other terms of the mask; 1 for none."""
        from scipy.special import fdtrc

        wider = mask.copy()
        wider[factor, : power + 1] = True
        added = (wider & ~mask)[wider]
        if not added.any():
            return 1.0
        found, covariance = self.solve(wider)
        size = found[wider][added]
        square = float(size @ _inverse(covariance[np.ix_(added, added)]) @ size)
        return float(fdtrc(size.size, self.freedom[factor], square / size.size))


def evidence(model: Model, coefficients: Array, levels: Levels, beside: Beside) -> Evidence:
    """The evidence of a recording at the fit ``coefficients`` (6, powers) of the fullest laws."""
    p, q = model.count, model.count + beside.count
    member = np.arange(len(levels))[:, None] == levels.of_reading

    def by_level(rows: slice, slopes: Array) -> Array:
        return np.asarray((slopes[:, None, :] * member[None, :, rows]).reshape(-1, slopes.shape[1]))

    total = sums(model, coefficients, beside, by_level)
    own = _inverse(total.gram[:q, :q])
    freedom = max(total.rows - q, 1)
    variance = max((total.squares - float(total.pull[:q] @ own @ total.pull[:q])) / freedom, 1e-28)
    across = total.gram[:p, p:q] @ _inverse(total.gram[p:q, p:q])
    information = total.gram[:p, :p] - across @ total.gram[p:q, :p]
    pull = total.pull[:p] - across @ total.pull[p:q]
    step = own @ total.pull[:q]
    colour = _colour(model, coefficients, beside, across, step) / variance
    by_factor = [np.mean(colour[[i for i, (k, _) in enumerate(model.places) if k == factor]]) for factor in range(6)]
    widening = np.maximum(by_factor, 1.0)
    scatter, spare = _scatter(total.gram, total.pull, q, len(levels), variance * widening)
    scatters = spare > 0
    return Evidence(
        terms=model.terms,
        coefficients=coefficients,
        information=information,
        pull=pull,
        variance=variance,
        widening=widening * np.where(scatters, scatter, 1.0),
        freedom=np.where(scatters, spare, freedom),
        scatters=scatters,
    )


def _scatter(gram: Array, pull: Array, q: int, levels: int, variance: Array) -> tuple[Array, Array]:
    """How far the levels of each factor (6,) stand from its law, in variances, and with how many degrees of freedom.

    1 and 0 where noise explains it. ``variance`` (6,) is that of each factor's columns.
    """
    from scipy.special import chdtrc

    own = _inverse(gram[:q, :q])
    size, spare = np.ones(6), np.zeros(6)
    for factor in range(6):
        place = slice(q + factor * levels, q + (factor + 1) * levels)
        across = gram[place, :q] @ own
        left = gram[place, place] - across @ gram[:q, place]
        push = pull[place] - across @ pull[:q]
        values, vectors = np.linalg.eigh(left)
        seen = values > _OF_ITS_OWN * np.max(np.diagonal(gram[place, place]))
        square = float(np.sum((vectors[:, seen].T @ push) ** 2 / values[seen])) / variance[factor]
        freedom = int(np.count_nonzero(seen))
        if freedom and chdtrc(freedom, square) < FAMILY_LEVEL / 6.0:
            size[factor], spare[factor] = max(square / freedom, 1.0), freedom
    return size, spare


def _colour(model: Model, coefficients: Array, beside: Beside, across: Array, step: Array) -> Array:
    """Variance of a reading (p,) that each term sees, which is more than its own where neighbours go together.

    The larger one of two estimates: from sums over blocks that are long against the correlation, and that of a
    first-order autoregression at low frequency. ``across`` (p, q - p) takes out of a term's column what the columns
    beside it explain; ``step`` (q,) leads to the minimum.
    """
    p, pieces = model.count, []
    for rows, residual, slopes, powers in model.linearised(coefficients):
        law, rest = model.columns(slopes, powers), beside.columns(model.recording, rows)
        pieces.append(residual - step[:p] @ law - step[p:] @ rest)
    left = np.concatenate(pieces)
    correlation, at_low_frequency = _autoregression(left, _frequencies(model, beside))
    length = _block_length(correlation, left.size)
    squares, weights = np.zeros(p), np.zeros(p)
    for rows, _, slopes, powers in model.linearised(coefficients):
        column = model.columns(slopes, powers) - across @ beside.columns(model.recording, rows)
        starts = np.arange(0, column.shape[1], length)
        squares += np.sum(np.add.reduceat(column * left[rows], starts, axis=1) ** 2, axis=1)
        weights += np.sum(column**2, axis=1)
    return np.asarray(np.maximum(squares / np.maximum(weights, 1e-300), at_low_frequency))


def _autoregression(left: Array, fitted_rad: Array) -> tuple[float, float]:
    """Correlation of neighbours and variance at low frequency of a first-order autoregression that left this (n,).

    0 and the plain variance where neighbours do not surely go together. ``fitted_rad`` (q,) are the frequencies, in
    radians a reading, of the columns that were fitted: the noise has lost what it held there, which is put back.
    """
    n = left.size
    found = np.array([left @ left, left[1:] @ left[:-1]]) / n
    if found[0] <= 0.0 or found[1] < _SURELY / np.sqrt(n) * found[0]:
        return 0.0, float(found[0]) * n / max(n - fitted_rad.size, 1)
    near = found
    for _ in range(_TURNS):
        correlation = float(np.clip(near[1] / near[0], 0.0, _MOST_CORRELATED))
        density = (1.0 - correlation**2) / (1.0 - 2.0 * correlation * np.cos(fitted_rad) + correlation**2)
        lost = near[0] * np.array([density.sum(), density @ np.cos(fitted_rad)]) / n
        near = found + np.minimum(lost, found[0])
    correlation = float(np.clip(near[1] / near[0], 0.0, _MOST_CORRELATED))
    return correlation, float(near[0]) * (1.0 + correlation) / (1.0 - correlation)


def _frequencies(model: Model, beside: Beside) -> Array:
    """Frequency (q,) of each column in radians a reading: the laws hold orders up to about 1 on average."""
    step = float(np.median(np.abs(wrap(np.diff(model.recording.reference_rad)))))
    orders = np.concatenate([np.ones(model.count + beside.directed_count), np.tile(beside.orders, 2)])
    return np.asarray(step * orders)


def _block_length(correlation: float, rows: int) -> int:
    """Readings in a block, by the rule for the long-run variance of a first-order autoregression (Andrews 1991)."""
    reach = float(np.cbrt(4.0 * correlation**2 / (1.0 - correlation**2) ** 2 * rows))
    return max(1, min(round(1.1447 * reach), rows // 20))


def _inverse(matrix: Array) -> Array:
    """Inverse of a symmetric matrix; a direction that it does not see gets an enormous variance."""
    size = np.diagonal(matrix)
    scale = 1.0 / np.sqrt(np.maximum(size, _SMALLEST * max(float(size.max(initial=0.0)), _SMALLEST)))
    values, vectors = np.linalg.eigh(matrix * scale[:, None] * scale)
    return np.asarray((vectors / np.maximum(values, _UNSEEN)) @ vectors.T * scale[:, None] * scale)
