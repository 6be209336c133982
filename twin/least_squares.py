"""Linear least squares of many readings and few columns."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, BoolArray

_CLEAR = 1e-6
"""Smallest eigenvalue of the normal equations, against the largest, of which they still tell ten digits."""


def fitted(columns: Array, values: Array, used: BoolArray) -> Array:
    """Coefficients (k,) of columns (n, k) whose sum is nearest to values (n,), by the rows in use.

    By the normal equations, which cost a tenth, where the columns are clearly independent; else by singular values.
    """
    counted = columns * used[:, None]
    gram = columns.T @ counted
    size = np.linalg.eigvalsh(gram)
    if size[0] > _CLEAR * size[-1]:
        return np.asarray(np.linalg.solve(gram, counted.T @ np.where(used, values, 0.0)))
    return np.asarray(np.linalg.lstsq(columns[used], values[used], rcond=None)[0])
