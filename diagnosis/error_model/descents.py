"""Descents on the quadratic form from several starts: where all end in one minimum, no swarm is needed to find it.

The form is cheap, and so smooth over the range of Table 2 that from anywhere in it the same minimum is reached, unless
the readings leave a part of the turn out. That is seen, not assumed: the starts are the ideal sensor and eight corners
of the range, in which each parameter stands as often at its upper as at its lower end and so do each two of the first
three (a fractional factorial design of eight runs).
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import least_squares
from diagnosis.error_model.model import NOMINAL, ZERO
from diagnosis.error_model.search_range import first_box
from twin.angles import Array

_FIRST = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
CORNERS: Array = np.column_stack(
    [_FIRST, _FIRST[:, 0] * _FIRST[:, 1], _FIRST[:, 0] * _FIRST[:, 2], _FIRST[:, 1] * _FIRST[:, 2]]
)
"""Signs (8, 6) of a two-level design of resolution III: the last three parameters follow products of the first."""
STARTS = 1 + len(CORNERS)
"""Of the descents for one sweep and one pair of senses."""
_ALIKE_SIGMA2 = 1e-4
"""Two ends are one minimum where their sums of squares differ by less than a hundredth of a standard error does."""


def starts(zero_rad: Array) -> Array:
    """The starts (batch, 9, 6) around these zeros (batch,): an ideal sensor first, then corners of Table 2's range."""
    box = first_box(zero_rad)
    middle = np.tile(NOMINAL, (zero_rad.size, 1))
    middle[:, ZERO] = zero_rad
    corners = np.where(CORNERS > 0.0, box.upper[:, None, :], box.lower[:, None, :])
    return np.concatenate([middle[:, None, :], corners], axis=1)


def descend(gram: Array, begun: Array, *, count: int) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Where the descents end.

    Parameters
    ----------
    gram : ndarray
        Quadratic forms (batch, 10, 10).
    begun : ndarray
        Starts (batch, starts, 6), see :func:`starts`.
    count : int
        Readings a sweep.

    Returns
    -------
    tuple of ndarray
        The end of the descent from the ideal sensor, (batch, 6); its sum of squares, (batch,); and whether all others
        end as low and no lower, (batch,).
    """
    batch, each, size = begun.shape
    forms = np.repeat(gram, each, axis=0)
    ended = least_squares.descend_on_gram(forms, begun.reshape(-1, size), count=count)
    cost = ended.cost.reshape(batch, each)
    least = cost.min(axis=1, keepdims=True)
    apart = _ALIKE_SIGMA2 * least / max(count - size, 1) + least_squares.rounding_of(gram)[:, None]
    agreed = np.all(cost - least <= apart, axis=1) & np.all(ended.settled.reshape(batch, each), axis=1)
    return ended.points.reshape(begun.shape)[:, 0], cost[:, 0], agreed
