"""When a series began to change: the maximum-likelihood change point, a step or a ramp, with a 95 % interval.

A chart signals some time after the change that it signals (Samuel, Pignatiello and Calvin 1998 for a step, Perry and
Pignatiello 2006 for a ramp). The values are taken as normal about a level that, from some value on, is another one or
moves evenly. Every start and both shapes are tried by least squares; each has its likelihood, with level, size and
scatter at their best. The interval is the shortest run of starts that holds 95 % of the likelihood, shapes added up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import Array

LEVEL = 0.95
_BEFORE = 2
"""Fewest values before a change: one has no scatter to depart from."""
_SMALLEST = 1e-30


@dataclass(frozen=True)
class Change:
    """Where a series (n,) began to change: index of the first changed value, its 95 % interval, shape and size.

    ``size`` is that of a step, or of all the way from the level to the last value of a ramp.
    """

    first: int
    low: int
    high: int
    shape: str
    size: float


def change_point(values: Array) -> Change:
    """The most likely change of a series of at least three values."""
    starts = np.arange(_BEFORE, values.size)
    fits = {shape: [_fitted(values, shape, int(start)) for start in starts] for shape in ("step", "ramp")}
    left = np.array([[squares for squares, _ in row] for row in fits.values()])
    log_likelihood = -0.5 * values.size * np.log(np.maximum(left, _SMALLEST * max(float(values @ values), 1.0)))
    which, place = np.unravel_index(int(np.argmax(log_likelihood)), left.shape)
    share = np.exp(log_likelihood - log_likelihood.max()).sum(axis=0)
    low, high = _shortest_run(share / share.sum())
    shape = list(fits)[which]
    return Change(
        first=int(starts[place]),
        low=min(int(starts[low]), int(starts[place])),
        high=max(int(starts[high]), int(starts[place])),
        shape=shape,
        size=float(fits[shape][int(place)][1]),
    )


def _fitted(values: Array, shape: str, start: int) -> tuple[float, float]:
    """Sum of squares that is left, and the size of the change, for a change of this shape from this value on."""
    since = np.maximum(np.arange(values.size) - start + 1.0, 0.0)
    course = np.minimum(since, 1.0) if shape == "step" else since / since[-1]
    course, about = course - course.mean(), values - values.mean()
    size = float(course @ about) / float(course @ course)
    left = about - size * course
    return float(left @ left), size


def _shortest_run(share: Array) -> tuple[int, int]:
    """First and last place of the shortest run that holds :data:`LEVEL`; the shares add up to 1."""
    below = np.concatenate([[0.0], np.cumsum(share)])
    last = np.searchsorted(below, below[:-1] + LEVEL - 1e-12)
    runs = [(end - 1 - start, start) for start, end in enumerate(last) if end < below.size]
    length, start = min(runs)
    return int(start), int(start + length)
