"""The noise of a bench as an autoregression of what fits leave, by which columns and readings are made white.

Correlated readings say less than their number. The order follows from the Bayesian information criterion (Schwarz
1978), the coefficients from the Yule-Walker equations; generalised least squares is then ordinary least squares of what
the filter leaves (Cochrane and Orcutt 1949). A filter of a few rows keeps blocks of rows apart from one another. The
correlation is the median over devices: of a single one, a cause that only it has would pass for noise.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from twin.angles import Array

HIGHEST_ORDER = 8
"""Rows that a reading's noise may depend on: beyond, what correlates is structure or a drift."""


def autoregression(residuals: Sequence[Array]) -> Array:
    """Coefficients (p,) of the autoregression that residuals (n,) of devices are best described by; none for white."""
    n = sum(residual.size for residual in residuals)
    highest = min(HIGHEST_ORDER, min(residual.size for residual in residuals) // 16)
    correlation = np.median([_correlation(residual, highest) for residual in residuals], axis=0)
    if correlation[0] <= 0.0:
        return np.zeros(0)
    best, lowest = np.zeros(0), n * np.log(correlation[0])
    coefficients, left = np.zeros(0), correlation[0]
    for order in range(1, highest + 1):
        # Levinson's recursion: each order from the one before.
        reflection = (correlation[order] - coefficients @ correlation[order - 1 : 0 : -1][: order - 1]) / left
        coefficients = np.append(coefficients - reflection * coefficients[::-1], reflection)
        left *= 1.0 - reflection**2
        if left <= 1e-12 * correlation[0]:
            break
        criterion = n * np.log(left) + order * np.log(n)
        if criterion < lowest:
            best, lowest = coefficients, criterion
    return best


def _correlation(residual: Array, highest: int) -> Array:
    """Correlation (highest + 1,) of readings so many rows apart; zeros where there is nothing but zeros."""
    found = np.array([residual[: residual.size - lag] @ residual[lag:] for lag in range(highest + 1)])
    return np.asarray(found / found[0] if found[0] > 0.0 else found)


def whitened(rows: Array, coefficients: Array) -> Array:
    """What the autoregression (p,) leaves of rows (..., n), as (..., n - p).

    The first p readings of each have nothing to be held against.
    """
    order = coefficients.size
    n = rows.shape[-1]
    left = rows[..., order:].copy()
    for lag, coefficient in enumerate(coefficients, 1):
        left -= coefficient * rows[..., order - lag : n - lag]
    return left
