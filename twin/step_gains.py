"""How much one further step of the mean would explain, at every row of a record at once."""

from __future__ import annotations

import numpy as np

from twin.angles import Array


def step_gains(left: Array, basis: Array, *, least: float) -> Array:
    """Squares (n,) that a step from each row on would take off what a fit has left (n,).

    ``basis`` (n, p) holds the fit's orthonormal columns. By sums over the rows behind each, so that all places cost no
    more than one. A step of which the columns do so much that fewer rows than ``least`` are its own gains nothing.
    """
    sums = np.cumsum(left[::-1])[::-1]
    done = np.cumsum(basis[::-1], axis=0)[::-1]
    own = np.arange(left.size, 0, -1) - np.sum(done**2, axis=1)
    return np.where(own >= least, sums**2 / np.maximum(own, 1e-9), 0.0)
