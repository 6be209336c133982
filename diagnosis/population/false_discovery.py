"""Many tests at once: which may be believed so that a stated share of what is believed is false at most, on average.

Where nothing is there at all, that share is the probability of any false alarm.

References: Benjamini and Hochberg (1995), J. R. Statist. Soc. B 57, 289; Benjamini and Yekutieli (2001), Ann. Statist.
29, 1165, Theorem 1.3, whose bound holds however the tests depend on one another.
"""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import BoolArray


def threshold(log_p: Array, share: float, *, independent: bool = False) -> float:
    """The log of what p values (of any shape; NaN: not tested) may be at most to be believed; -inf: none is.

    ``independent`` tests need not pay for how they may depend on one another.
    """
    ranked = np.sort(log_p[~np.isnan(log_p)])
    if ranked.size == 0:
        return -np.inf
    ranks = np.arange(1, ranked.size + 1)
    limits = np.log(share * ranks / (ranked.size * (1.0 if independent else np.sum(1.0 / ranks))))
    below = np.flatnonzero(ranked <= limits)
    return float(limits[below[-1]]) if below.size else -np.inf


def believed(log_p: Array, share: float) -> BoolArray:
    """Which of the tests may be believed, of the same shape."""
    limit = threshold(log_p, share)
    return np.asarray((log_p <= limit) & np.isfinite(limit) | (log_p == -np.inf))
