"""A motion as a penalised spline: smooth in time, stretch by stretch, as freely as the readings show it to be.

Cubic B-splines with a penalty on the third differences of their coefficients (P. H. C. Eilers, B. D. Marx, Stat. Sci.
11 (1996) 89): the torque is taken for a random walk. All matrices are banded, so that a fit costs a few passes over the
readings.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from twin.angles import Array, IntArray

DEGREE = 3
PENALISED = 3
"""Order of the differences that are penalised: what a constant torque does, a parabola, costs nothing."""
ROWS_A_KNOT = 4
MOST_KNOTS = 2000
"""Of a log. Each then spans five readings of ten thousand; with more a fit of a long log would take minutes."""
FEWEST_KNOTS = 4


@dataclass(frozen=True, eq=False)
class Spline:
    """A spline on each of several stretches of time.

    ``design`` is the sparse matrix (n, k) of the basis at the readings, ``rough`` that (d, k) of the third differences,
    ``spacing_s`` the time between two knots, ``at_s`` (d,) the time in the middle of each difference.
    """

    design: Any
    rough: Any
    spacing_s: float
    at_s: Array

    @classmethod
    def over(cls, time_s: Array, ends: Sequence[int]) -> Spline:
        """The splines for readings at these times (n,), of stretches that end at ``ends`` (one past the last row)."""
        from scipy.interpolate import BSpline
        from scipy.sparse import block_diag, diags_array

        starts = [0, *ends[:-1]]
        total = sum(float(time_s[end - 1] - time_s[start]) for start, end in zip(starts, ends, strict=True))
        aim = max(ROWS_A_KNOT * total / time_s.size, total / MOST_KNOTS)
        bases, differences, middles = [], [], []
        for start, end in zip(starts, ends, strict=True):
            own = time_s[start:end]
            first, span = float(own[0]), float(own[-1] - own[0])
            count = max(round(span / aim), FEWEST_KNOTS)
            step = span / count
            knots = first + step * np.arange(-DEGREE, count + DEGREE + 1)
            inside = np.clip(own, first, np.nextafter(first + span, first))
            bases.append(BSpline.design_matrix(inside, knots, DEGREE))
            size = count + DEGREE
            stencil = np.array([-1.0, 3.0, -3.0, 1.0])
            rows = size - PENALISED
            differences.append(diags_array(stencil, offsets=np.arange(4), shape=(rows, size)))
            middles.append(first + step * (np.arange(rows) + 0.5))
        return cls(block_diag(bases, format="csr"), block_diag(differences, format="csr"), aim, np.concatenate(middles))

    @cached_property
    def size(self) -> int:
        """How many coefficients there are."""
        return int(self.design.shape[1])

    def bands(self, weights: Array, stiffness: Array) -> Array:
        """Lower bands (4, k) of the normal matrix of readings weighed so (n,) and differences held so (d,)."""
        normal = (self.design.T.multiply(weights)) @ self.design + (self.rough.T.multiply(stiffness)) @ self.rough
        out = np.zeros((DEGREE + 1, self.size))
        for band in range(DEGREE + 1):
            out[band, : self.size - band] = normal.diagonal(-band)
        return out


def stretch_ends(stretch: IntArray) -> list[int]:
    """One past the last row of each run of equal numbers (n,)."""
    return [*(np.flatnonzero(np.diff(stretch)) + 1).tolist(), int(stretch.size)]


def pieces(ends: Sequence[int]) -> list[slice]:
    """The rows of each stretch."""
    return [slice(a, b) for a, b in itertools.pairwise([0, *ends])]
