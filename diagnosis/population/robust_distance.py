"""How far each device stands from the rest, in units of the rest's own scatter, which odd devices do not widen.

Centre and scatter are the orthogonalised Gnanadesikan-Kettenring estimate of Maronna and Zamar: pairwise robust
variances, made positive definite through their principal axes, then once more the plain mean and covariance of the
devices that lie within. It takes one pass and no random start.

Reference: Maronna and Zamar (2002), Technometrics 44, 307.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.confidence import OF_MAD

_WITHIN = 0.975
"""Share of normal devices that the second estimate is taken from; it is scaled up for those that it leaves out."""


@dataclass(frozen=True, eq=False)
class Rest:
    """Centre (F,) and covariance (F, F) of devices that do not stand apart."""

    centre: Array
    covariance: Array

    def squares(self, values: Array, more: Array | None = None) -> Array:
        """Squared distances (N,) of devices (N, F); some scatter by ``more`` variances (N, F) than the rest."""
        off = values - self.centre
        if more is not None:
            wider = self.covariance + more[:, :, None] * np.eye(more.shape[1])
            return np.asarray(np.einsum("nf,nfg,ng->n", off, np.linalg.pinv(wider, hermitian=True), off))
        return np.asarray(np.einsum("nf,nf->n", off @ np.linalg.pinv(self.covariance, hermitian=True), off))

    def scores(self, values: Array) -> Array:
        """Each figure (N, F) by itself, in standard deviations of the rest."""
        return np.asarray((values - self.centre) / np.sqrt(np.maximum(np.diagonal(self.covariance), 1e-300)))


def rest_of(values: Array) -> Rest:
    """Centre and covariance of the bulk of devices (N, F)."""
    from scipy.special import chdtr, chdtri

    count = values.shape[1]
    middle, size = np.median(values, axis=0), _scale(values)
    size = np.where(size > 0.0, size, 1.0)
    unit = (values - middle) / size
    pairs = 0.25 * (_scale(unit[:, :, None] + unit[:, None, :]) ** 2 - _scale(unit[:, :, None] - unit[:, None, :]) ** 2)
    np.fill_diagonal(pairs, 1.0)
    _, axes = np.linalg.eigh(pairs)
    along = unit @ axes
    centre, lengths = np.median(along, axis=0), np.maximum(_scale(along), 1e-12)
    squares = np.sum(((along - centre) / lengths) ** 2, axis=1)
    squares *= chdtri(count, 0.5) / max(float(np.median(squares)), 1e-300)
    limit = float(chdtri(count, 1.0 - _WITHIN))
    inside = values[squares <= limit]
    # A normal cloud cut off at this distance has this share of its variance.
    left = float(chdtr(count + 2, limit)) / _WITHIN
    return Rest(inside.mean(axis=0), np.atleast_2d(np.cov(inside.T)) / left)


def _scale(values: Array) -> Array:
    """Median absolute deviation along the first axis, as a standard deviation of normal values."""
    return np.asarray(OF_MAD * np.median(np.abs(values - np.median(values, axis=0)), axis=0))
