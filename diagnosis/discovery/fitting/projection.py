"""Projection: what a vector has that columns cannot do, nearly dependent ones among them."""

from __future__ import annotations

import numpy as np

from twin.angles import Array


def projected(residual: Array, columns: Array) -> Array:
    """The residual (N,), or several of them (..., N), less all that the columns (P, N) can do."""
    norm = np.linalg.norm(columns, axis=1)
    columns = columns[norm > 0.0] / norm[norm > 0.0, None]
    size, vectors = np.linalg.eigh(columns @ columns.T)
    kept = size > 1e-12 * size.max(initial=0.0)
    along = (residual @ columns.T) @ (vectors[:, kept] / size[kept]) @ vectors[:, kept].T
    return np.asarray(residual - along @ columns)
