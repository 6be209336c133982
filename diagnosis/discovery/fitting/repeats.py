"""Readings repeated in place: how far they scatter, and how alike neighbours among them are.

Their scatter is the noise with nothing of the model in it (pure error), which tells lack of fit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import Array, IntArray

_ONE_SIDED_95 = 1.645


@dataclass(frozen=True, eq=False)
class Repeats:
    """Of each row (n,) the number of readings ``count``, the sum of squares of their deviations from the row's mean
    ``squares`` [rad^2], and the sum ``products`` of those of each with the next."""

    count: Array
    squares: Array
    products: Array

    @classmethod
    def of(cls, deviation: Array, group: IntArray) -> Repeats:
        """From the deviations (n_raw,) [rad] of the readings from the means of their rows, and each one's row."""
        together = group[1:] == group[:-1]
        neighbours = np.where(together, deviation[1:] * deviation[:-1], 0.0)
        return cls(
            count=np.bincount(group).astype(np.float64),
            squares=np.asarray(np.bincount(group, deviation**2), dtype=np.float64),
            products=np.asarray(np.bincount(group, np.append(0.0, neighbours)), dtype=np.float64),
        )

    @property
    def freedom(self) -> Array:
        """Degrees of freedom (n,) of each row's squares."""
        return np.asarray(self.count - 1.0)

    def correlation(self) -> float:
        """The largest correlation of neighbouring readings, as of AR(1), that the deviations do not exclude at 95 %.

        A mean takes a part of it away: the ratio of products and squares is held against what it is expected to be.
        """
        from scipy.optimize import brentq

        size, rows = np.unique(self.count[self.count > 1], return_counts=True)
        pairs = float(rows @ (size - 1.0))
        total = float(np.sum(self.squares))
        if total <= 0.0 or pairs < 2.0:
            return 0.0
        seen = float(np.sum(self.products)) / total
        highest = seen + _ONE_SIDED_95 / float(np.sqrt(pairs))

        def short_of(correlation: float) -> float:
            moments = np.array([_moments(int(m), correlation) for m in size])
            squares, products, _ = rows @ moments
            return float(products / squares) - highest

        if short_of(0.0) >= 0.0:
            return 0.0
        return float(brentq(short_of, 0.0, _MOST)) if short_of(_MOST) > 0.0 else _MOST

    def variance_of_means(self, rows: IntArray) -> Array:
        """Variance (k,) [rad^2] of the means of these rows (k,) by the scatter of their readings alone.

        Of correlated readings a mean tells less than of independent ones, but no less than one of them: what wanders
        more slowly than readings are repeated is not what they scatter by.
        """
        correlation = self.correlation()
        size, place = np.unique(self.count, return_inverse=True)
        moments = np.array([_moments(int(m), correlation) for m in size])
        expected = moments[place]
        unit = float(np.sum(self.squares[rows]) / np.sum(expected[rows, 0]))
        single = float(np.sum(self.squares[rows]) / np.sum(self.freedom[rows]))
        return np.asarray(np.minimum(unit * expected[rows, 2], single))


_MOST = 0.99


def _moments(count: int, correlation: float) -> tuple[float, float, float]:
    """Expected squares and products of deviations from the mean, and the mean's variance, of AR(1) of variance 1."""
    lag = np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    covariance = correlation**lag
    centre = np.eye(count) - 1.0 / count
    left = centre @ covariance @ centre
    return float(np.trace(left)), float(np.trace(left, offset=1)), float(np.mean(covariance))
