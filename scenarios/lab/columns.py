"""Many readings as a picture can show them: of each pixel's column the lowest and the highest."""

from __future__ import annotations

from typing import Any

import numpy as np

from twin.angles import Array

_DIGITS = 6
MOST_POINTS = 2500
"""Readings that are drawn one by one, however narrow the picture."""


def drawn(x: Array, y: Array, span: tuple[float, float], width: int) -> dict[str, Any]:
    """Readings (n,) for a picture of so many columns: each of them, or of many more than columns the extremes."""
    if x.size <= max(2 * width, MOST_POINTS):
        return {"x": _plain(x), "y": _plain(y)}
    at, low, high = extremes(x, y, span, width)
    return {"x": _plain(at), "low": _plain(low), "high": _plain(high)}


def extremes(x: Array, y: Array, span: tuple[float, float], width: int) -> tuple[Array, Array, Array]:
    """Middle of each column that holds any reading, and the lowest and highest in it."""
    place, size = _columns(x, span, width)
    order = np.argsort(place, kind="stable")
    kept, first = np.unique(place[order], return_index=True)
    values = y[order]
    at = span[0] + (kept + 0.5) * size
    return at, np.minimum.reduceat(values, first), np.maximum.reduceat(values, first)


def highest_in_columns(x: Array, y: Array, beside: Array, width: int) -> tuple[Array, Array, Array]:
    """The highest y of each column with its own x and what stands beside it; all, where they are no more."""
    if x.size <= width:
        return x, y, beside
    place, _ = _columns(x, (float(x.min()), float(x.max())), width)
    # By column, and within it by height: the last of each is its highest.
    order = np.lexsort((y, place))
    last = np.flatnonzero(np.diff(place[order], append=-1) != 0)
    chosen = order[last]
    return x[chosen], y[chosen], beside[chosen]


def _columns(x: Array, span: tuple[float, float], width: int) -> tuple[Any, float]:
    """The column of each value, and a column's width."""
    size = max(span[1] - span[0], 1e-12) / width
    return np.clip(((x - span[0]) / size).astype(np.int64), 0, width - 1), size


def _plain(values: Array) -> Any:
    return np.round(values, _DIGITS).tolist()
