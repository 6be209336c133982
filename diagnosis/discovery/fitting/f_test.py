"""The F test, as a log probability that holds far out in the tail."""

from __future__ import annotations

import numpy as np

from twin.angles import Array


def log_probability(gain: Array, terms: int, dof: Array | int) -> Array:
    """Log of the probability that Gaussian noise gains as much: the F test, with ``gain = -dof log(rss1/rss0)``."""
    from scipy.special import betainc, betaln

    share = np.exp(-np.maximum(gain, 0.0) / np.maximum(dof, 1))
    a, b = 0.5 * np.maximum(dof - terms, 1), 0.5 * terms
    plain = betainc(a, b, share)
    with np.errstate(divide="ignore"):
        tail = a * np.log(np.maximum(share, 1e-300)) + (b - 1.0) * np.log1p(-np.minimum(share, 1 - 1e-16))
        tail = tail - betaln(a, b) - np.log(a)
        return np.asarray(np.where(plain > 1e-280, np.log(np.maximum(plain, 1e-300)), tail))
