"""Held-out residuals less what their neighbours foretell: single rows can then be held out in coloured noise, too.

Noise that is correlated from row to row shows in the neighbours of a row that is left out. A cause that no more than
follows it gains nothing on what they do not foretell; a step does, which no slow noise makes.
"""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.coefficients import to_cosine
from diagnosis.discovery.fitting.joint_fit import Fit
from twin.angles import Array
from twin.noise import spectrum


def unforeseen(fit: Fit, residual: Array) -> Array:
    """Each row's residual less its expectation by all others', by the noise of a fit.

    Parameters
    ----------
    fit : Fit
        Whose noise, of covariance K, the residuals have.
    residual : ndarray
        Residuals (n,) [rad], NaN where there is none.

    Returns
    -------
    ndarray
        (K^-1 r)_i / (K^-1)_ii, (n,) [rad]: the residuals themselves in white noise. Rows without one stay NaN.

    References
    ----------
    Leave-one-out of a Gaussian process: Sundararajan and Keerthi, Neural Computation 13 (2001) 1103.
    """
    observations, weight = fit.observations, fit.weighting.family.weights[fit.weighting.member]
    known = np.isfinite(residual) & observations.usable
    left = to_cosine(observations, np.where(known, residual, 0.0))
    pulled = spectrum.to_rows(weight * left, observations.lengths)
    return np.where(known, pulled / _diagonal(weight, observations.lengths) * observations.scale, np.nan)


def _diagonal(weight: Array, lengths: tuple[int, ...]) -> Array:
    """Diagonal (n,) of the inverse covariance whose inverse spectra (n,) are ``weight``, sequence by sequence."""
    return np.concatenate([_of_sequence(own) for own in np.split(weight, np.cumsum(lengths)[:-1])])


def _of_sequence(weight: Array) -> Array:
    """Sum (n,) over the coefficients k of weight_k times the square of the k-th cosine at each row.

    That square is (1 + cos(2 pi k (i + 1/2) / n)) / n, and 1/n of the first: what the rows add is a cosine transform of
    twice the length, at every second place.
    """
    from scipy.fft import dct

    n = weight.size
    places = np.zeros(2 * n + 1)
    places[0 : 2 * n : 2] = weight
    waves = 0.5 * (dct(places, type=1)[1::2] + weight[0])
    return np.asarray((weight.sum() + waves - weight[0]) / n)
