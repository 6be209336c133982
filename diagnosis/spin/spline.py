"""A motion as a penalised spline: smooth in time, stretch by stretch, as freely as the readings show it to be.

Cubic B-splines with a penalty on the third differences of their coefficients (P. H. C. Eilers, B. D. Marx, Stat. Sci.
11 (1996) 89): the torque is taken for a random walk. All matrices are banded, so that a fit costs a few passes over the
readings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from twin.angles import Array
from twin.estimated_motion import SPECTRAL_SLOPE

DEGREE = 3
PENALISED = SPECTRAL_SLOPE // 2
"""Order of the differences that are penalised, three: what a constant torque does, a parabola, costs nothing."""
ROWS_A_KNOT = 4
MOST_KNOTS = 2000
"""Of a log: each then spans five readings of ten thousand."""
FEWEST_KNOTS = 4
_THIRD = np.array([-1.0, 3.0, -3.0, 1.0])
_SECOND = np.array([0.5, -0.5, -0.5, 0.5])
"""The mean of two second differences, which lies where the third one does."""


@dataclass(frozen=True, eq=False)
class Spline:
    """A spline on each of several stretches of time.

    ``design`` is the sparse matrix (n, k) of the basis at the readings, ``rough`` that (d, k) of the third differences,
    ``bent`` that (d, k) of the second ones, ``step_s`` (d,) the time between two knots and ``spacing_s`` the usual one,
    ``at_s`` (d,) the time in the middle of each difference, ``sizes`` how many coefficients each stretch has.
    """

    design: Any
    rough: Any
    bent: Any
    step_s: Array
    spacing_s: float
    at_s: Array
    sizes: tuple[int, ...]

    @classmethod
    def over(cls, time_s: Array, stretches: Sequence[slice]) -> Spline:
        """The splines for readings at these times (n,), of these stretches one behind the other."""
        from scipy.interpolate import BSpline
        from scipy.sparse import block_diag, diags_array

        total = sum(float(np.ptp(time_s[rows])) for rows in stretches)
        aim = max(ROWS_A_KNOT * total / time_s.size, total / MOST_KNOTS)
        bases, thirds, seconds, steps, middles = [], [], [], [], []
        for rows in stretches:
            own = time_s[rows]
            first, span = float(own[0]), float(own[-1] - own[0])
            count = max(round(span / aim), FEWEST_KNOTS)
            step = span / count
            knots = first + step * np.arange(-DEGREE, count + DEGREE + 1)
            inside = np.clip(own, first, np.nextafter(first + span, first))
            bases.append(BSpline.design_matrix(inside, knots, DEGREE))
            size = count + DEGREE
            held = size - PENALISED
            thirds.append(diags_array(_THIRD, offsets=np.arange(4), shape=(held, size)))
            seconds.append(diags_array(_SECOND, offsets=np.arange(4), shape=(held, size)))
            steps.append(np.full(held, step))
            middles.append(first + step * (np.arange(held) + 0.5))
        design, rough, bent = (block_diag(blocks, format="csr") for blocks in (bases, thirds, seconds))
        return cls(
            design,
            rough,
            bent,
            np.concatenate(steps),
            aim,
            np.concatenate(middles),
            tuple(base.shape[1] for base in bases),
        )

    @cached_property
    def size(self) -> int:
        """How many coefficients there are."""
        return int(self.design.shape[1])


def bands(matrix: Any, weights: Array) -> Array:
    """Lower bands (4, k) of the normal matrix of a sparse matrix (n, k) whose rows are weighed so (n,)."""
    normal = matrix.T.multiply(weights) @ matrix
    size = int(matrix.shape[1])
    out = np.zeros((DEGREE + 1, size))
    for band in range(DEGREE + 1):
        out[band, : size - band] = normal.diagonal(-band)
    return out


def rate(values: Array, time_s: Array, stretches: Sequence[slice]) -> Array:
    """Change (n,) of smooth values (n,) a second, stretch by stretch; none in a stretch of one reading."""
    found = np.zeros(values.size)
    for rows in stretches:
        if rows.stop - rows.start > 1:
            found[rows] = np.gradient(values[rows], time_s[rows])
    return found
