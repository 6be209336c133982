"""Sums over the readings of all products of two features, from the harmonics of the shaft up to the fourth.

The ten features of a reading are the harmonics (1, c, s, cos 2, sin 2) of the shaft, times a number u and times a
number v. A product of two of these harmonics is a sum of harmonics up to the fourth, so the 100 sums of products of
two features are combinations of 27: those of the nine harmonics times u u, u v and v v. The harmonics follow from c
and s by Chebyshev's recurrence, whose rounding stays within some 1e-15 up to the fourth.
"""

from __future__ import annotations

import numpy as np

from twin.angles import Array

SHAFT = 5
"""Harmonics of the shaft in the features."""
HARMONICS = 9
"""Harmonics in their products."""


class Moments:
    """Sums (batch..., harmonics, rows) over readings that come piece by piece.

    The harmonics and the rows of each piece are written into the same memory, which so stays in the processor's cache.
    """

    def __init__(self, batch: tuple[int, ...], longest: int, *, rows: int, harmonics: int = HARMONICS) -> None:
        self._harmonics: Array = np.ones((*batch, harmonics, longest))
        self._rows: Array = np.empty((*batch, rows, longest))
        self.total: Array = np.zeros((*batch, harmonics, rows))

    def piece(self, cosine: Array, sine: Array) -> tuple[Array, Array]:
        """The harmonics of shaft angles with cosine and sine (batch..., n), and as many rows to be filled.

        Of the harmonics (batch..., harmonics, n) 1, c, s, cos 2, sin 2, cos 3 ... those that are summed.
        """
        count = cosine.shape[-1]
        out = self._harmonics[..., :count]
        out[..., 1, :] = cosine
        out[..., 2, :] = sine
        doubled = (cosine + cosine)[..., None, :]
        np.multiply(out[..., 1:3, :], doubled, out=out[..., 3:5, :])
        out[..., 3, :] -= 1.0
        for k in range(5, out.shape[-2], 2):
            pair = out[..., k : k + 2, :]
            np.multiply(out[..., k - 2 : k, :], doubled, out=pair)
            pair -= out[..., k - 4 : k - 2, :]
        return out, self._rows[..., :count]

    def add(self, harmonics: Array, rows: Array) -> None:
        """Sum the harmonics of a piece times its rows."""
        self.total += harmonics @ np.swapaxes(rows, -1, -2)


def products(first: Array, second: Array, weights: Array | None, out: Array) -> None:
    """Write u u, u v and v v of u and v (..., n), times the weights (..., n), into rows (..., 3, n)."""
    left, right = (first, second) if weights is None else (first * weights, second * weights)
    np.multiply(left, first, out=out[..., 0, :])
    np.multiply(left, second, out=out[..., 1, :])
    np.multiply(right, second, out=out[..., 2, :])


def gram(sums: Array) -> Array:
    """The sums (..., 10, 10) of products of two features, from those (..., 9, 3) of u u, u v and v v."""
    flat = sums.reshape(*sums.shape[:-2], 3 * HARMONICS)
    return np.asarray(flat @ _COMBINED).reshape(*sums.shape[:-2], 2 * SHAFT, 2 * SHAFT)


def _order(row: int) -> tuple[int, bool]:
    """Order of a harmonic, and whether it is a sine."""
    return (row + 1) // 2, row > 0 and row % 2 == 0


def _product(first: int, second: int) -> dict[int, float]:
    """Rows and shares of the harmonics whose sum is the product of two."""
    (one, one_sine), (other, other_sine) = _order(first), _order(second)
    below, above = abs(one - other), one + other
    if one_sine == other_sine:
        # cos cos and sin sin: half the cosine of the difference, plus or minus half that of the sum.
        shares = [(below, False, 0.5), (above, False, -0.5 if one_sine else 0.5)]
    else:
        # sin cos: half the sine of the sum, plus half that of the sine's order less the cosine's.
        sine, cosine = (one, other) if one_sine else (other, one)
        shares = [(above, True, 0.5), (below, True, 0.5 * np.sign(sine - cosine))]
    out: dict[int, float] = {}
    for order, is_sine, share in shares:
        row = 2 * order - (0 if is_sine or order == 0 else 1)
        out[row] = out.get(row, 0.0) + (0.0 if is_sine and order == 0 else share)
    return out


def _combinations() -> Array:
    """What each of the 27 sums brings to each of the 100, (27, 100)."""
    out = np.zeros((HARMONICS, 3, 2, SHAFT, 2, SHAFT))
    for first in range(SHAFT):
        for second in range(SHAFT):
            for row, share in _product(first, second).items():
                for pair, (left, right) in enumerate(((0, 0), (0, 1), (1, 1))):
                    out[row, pair, left, first, right, second] = share
                    out[row, pair, right, first, left, second] = share
    return out.reshape(3 * HARMONICS, 4 * SHAFT * SHAFT)


_COMBINED = _combinations()
