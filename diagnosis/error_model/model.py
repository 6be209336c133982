"""The paper's reduced error model (Eq. 1, 2, 4, 5): six visible parameters, a residual linear in their monomials.

With a = s theta + zero the two channels are

    x = Vx + F(cos a),   y = g (Vy + F(sin(a + beta))),   F(c) = c + q c^2,   measured m = h atan2(y, x).

The common scale of (Ax, Ay, Vx, Vy) cannot be seen in an angle; the gauge is Ax = 1, so Vx stands for Vx/Ax, Vy for
Vy/Ay and g for Ay/Ax. A point of the model is an array (..., 6) in the order of :data:`NAMES`: fractions of the
amplitude, a ratio, radians.

Written out, y cos(hm) - x sin(hm) = r sin(atan2(y, x) - hm) is a sum of ten products of a *feature* of the reading
and a *coefficient* that holds nothing but parameters. Its sum of squares is therefore a quadratic form whose 10 x 10
matrix is built in one pass: what a particle of the swarm costs does not depend on the number of readings. Weights
1/r^2 turn it into the sum of squared sines of the angle error.

    readings = Readings.of(reference_rad, measured_rad)            # (..., n) each
    gram = readings.gram()                                         # (..., 10, 10)
    sum_of_squares = cost(coefficients(points), factor(gram))      # points (..., particles, 6)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import moments
from twin.angles import Array, cos_sin, wrap
from twin.baseline import FACTORS

NAMES = ("Vx_over_Ax", "Vy_over_Ay", "gain_ratio", "beta_rad", "quad", "zero_rad")
VX, VY, GAIN, BETA, QUAD, ZERO = range(6)
NOMINAL: Array = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
"""The point of an ideal sensor (6,)."""

LOWER_LIMIT: Array = np.array([-0.9, -0.9, 0.2, -np.pi / 4, -0.3, -np.inf])
UPPER_LIMIT: Array = np.array([0.9, 0.9, 5.0, np.pi / 4, 0.3, np.inf])
"""What the twin's effects accept; beyond it a curve is no longer a reading that follows the shaft."""

_CHUNK_ROWS = 16384
"""Of a piece: some twenty rows of so many numbers stay in the processor's cache."""
_MIRROR_FEATURES: Array = np.array([1, 1, -1, 1, -1, -1, -1, 1, -1, 1], dtype=np.float64)


def mirrored(points: Array) -> Array:
    """The points (..., 6) that make the same curve with both senses swapped; exact only where q = 0.

    With a -> -a the x channel stays and the y channel changes sign, but F is not odd: only q parts the two.
    """
    return np.asarray(points * np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0]))


def twin_values(point: Array) -> dict[str, dict[str, float]]:
    """A point (6,) as parameters of the twin's effects, by effect name; the zero in (-180, 180] deg."""
    values: dict[str, dict[str, float]] = {FACTORS[ZERO].key: {}}
    for place, factor in enumerate(FACTORS):
        value = -float(wrap(-point[place])) if place == ZERO else float(point[place])
        values.setdefault(factor.key, {})[factor.param] = value * factor.per_coordinate
    return values


def coefficients(points: Array) -> Array:
    """Points (..., 6) to coefficients (..., 10), in the order of :meth:`Readings.features`."""
    vx, vy, gain, beta, quad, zero = _unpacked(points)
    half = 0.5 * quad
    out = np.empty((*points.shape[:-1], 10))
    # Both sines and cosines are needed twice: this is the inner loop of the swarm.
    angles = np.stack([zero + beta, zero])
    (sb, sz), (cb, cz) = np.sin(angles), np.cos(angles)
    out[..., 0] = gain * (vy + half)
    rise = gain * sb
    run = gain * cb
    out[..., 1] = rise
    out[..., 2] = run
    out[..., 3] = half * (gain - 2.0 * run * cb)
    out[..., 4] = quad * rise * cb
    np.subtract(-vx, half, out=out[..., 5])
    np.negative(cz, out=out[..., 6])
    out[..., 7] = sz
    out[..., 8] = half - quad * cz * cz
    out[..., 9] = quad * sz * cz
    return out


def _unpacked(points: Array) -> tuple[Array, Array, Array, Array, Array, Array]:
    """The six parameters of points (..., 6), each (...)."""
    return (points[..., 0], points[..., 1], points[..., 2], points[..., 3], points[..., 4], points[..., 5])


def coefficient_slopes(points: Array) -> Array:
    """Derivatives of the coefficients with respect to the parameters: points (..., 6) to (..., 10, 6)."""
    _, vy, gain, beta, quad, zero = _unpacked(points)
    shifted = zero + beta
    cz, sz, cb, sb = np.cos(zero), np.sin(zero), np.cos(shifted), np.sin(shifted)
    c2z, s2z, c2b, s2b = cz * cz - sz * sz, 2 * sz * cz, cb * cb - sb * sb, 2 * sb * cb
    half = 0.5 * quad
    out = np.zeros((*points.shape[:-1], 10, 6))
    out[..., 0, VY] = gain
    out[..., 0, QUAD] = 0.5 * gain
    out[..., 3, QUAD] = -0.5 * gain * c2b
    out[..., 4, QUAD] = 0.5 * gain * s2b
    for row, value in enumerate((vy + half, sb, cb, -half * c2b, half * s2b)):
        out[..., row, GAIN] = value
    for row, value in ((1, gain * cb), (2, -gain * sb), (3, gain * quad * s2b), (4, gain * quad * c2b)):
        out[..., row, BETA] = value
        out[..., row, ZERO] = value
    out[..., 5, VX] = -1.0
    out[..., 5, QUAD] = -0.5
    out[..., 8, QUAD] = -0.5 * c2z
    out[..., 9, QUAD] = 0.5 * s2z
    for row, value in ((6, sz), (7, cz), (8, quad * s2z), (9, quad * c2z)):
        out[..., row, ZERO] = value
    return out


def factor(gram: Array) -> Array:
    """A matrix L with L L^T = gram (..., 10, 10), also where gram is singular (fewer readings than features)."""
    values, vectors = np.linalg.eigh(gram)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :])


def cost(coefs: Array, root: Array) -> Array:
    """Sum of squares (..., particles) of coefficients (..., particles, 10) on a factor (..., 10, 10)."""
    product = coefs @ root
    return np.asarray(np.einsum("...i,...i->...", product, product))


@dataclass(frozen=True, eq=False)
class Readings:
    """Cosines and sines of s theta and of h m, each (..., n); the weight of each reading (..., n), or None for 1."""

    cos_shaft: Array
    sin_shaft: Array
    cos_read: Array
    sin_read: Array
    weights: Array | None = None

    @classmethod
    def of(
        cls,
        reference_rad: Array,
        measured_rad: Array,
        *,
        sensor_sense: float | Array = 1.0,
        output_sense: float | Array = 1.0,
        weights: Array | None = None,
    ) -> Readings:
        """From angles (..., n) [rad], wrapped or not; senses +1 or -1, broadcast against them."""
        shaft, read = cos_sin(reference_rad), cos_sin(measured_rad)
        return cls(*shaft, *read, weights).in_senses(np.asarray(sensor_sense), np.asarray(output_sense))

    def in_senses(self, sensor: Array, output: Array) -> Readings:
        """The readings with these senses, +1 or -1, broadcast against them, in place of +1 and +1."""
        if np.all(sensor == 1.0) and np.all(output == 1.0):
            return self
        return replace(self, sin_shaft=sensor * self.sin_shaft, sin_read=output * self.sin_read)

    def resultant(self, sense: float = 1.0) -> tuple[Array, Array]:
        """Sums (...,) of cosine and sine of h m - sense s theta, by the weights."""
        c, s = self.cos_read, self.sin_read
        if self.weights is not None:
            c, s = c * self.weights, s * self.weights
        cc, ss, sc, cs = (
            (read[..., None, :] @ shaft[..., None])[..., 0, 0]
            for read, shaft in (
                (c, self.cos_shaft),
                (s, self.sin_shaft),
                (s, self.cos_shaft),
                (c, self.sin_shaft),
            )
        )
        return cc + sense * ss, sc - sense * cs

    @property
    def count(self) -> int:
        """Readings a sweep."""
        return int(self.cos_shaft.shape[-1])

    def oriented(self, swap: NDArray[np.bool_]) -> Readings:
        """The readings with both senses swapped in the sweeps where ``swap`` (batch,) says so."""
        if not swap.any():
            return self
        sign = np.where(swap, -1.0, 1.0)[:, None]
        shaft, read = (np.reshape(sign * sine, sine.shape) for sine in (self.sin_shaft, self.sin_read))
        return replace(self, sin_shaft=shaft, sin_read=read)

    def sweeps(self, which: Any) -> Readings:
        """Some of the readings: a mask, indices or a tuple of them, as an array (batch, n) takes it."""
        return self._part(which)

    def weighted(self, weights: Array | None) -> Readings:
        """The same readings with other weights (..., n)."""
        return replace(self, weights=weights)

    @property
    def longest(self) -> int:
        """Readings a sweep of a piece, see :meth:`chunks`."""
        sweeps = int(np.prod(self.cos_shaft.shape[:-1], dtype=np.int64))
        return min(max(_CHUNK_ROWS // max(sweeps, 1), 256), self.count)

    def chunks(self) -> Iterator[tuple[slice, Readings]]:
        """Consecutive pieces that stay in the processor's cache, with the rows they cover."""
        size = self.longest
        for start in range(0, self.count, size):
            rows = slice(start, min(start + size, self.count))
            yield rows, self._part((..., rows))

    def _part(self, where: Any) -> Readings:
        weights = None if self.weights is None else self.weights[where]
        return Readings(
            self.cos_shaft[where], self.sin_shaft[where], self.cos_read[where], self.sin_read[where], weights
        )

    def features(self) -> Array:
        """The ten products (..., n, 10): (1, c, s, cos 2, sin 2) of the shaft times cos, then times sin, of m."""
        c, s = self.cos_shaft, self.sin_shaft
        out = np.empty((*np.broadcast_shapes(c.shape, self.cos_read.shape), 10))
        shaft: tuple[float | Array, ...] = (1.0, c, s, c * c - s * s, 2.0 * c * s)
        for k, part in enumerate(shaft):
            out[..., k] = part * self.cos_read
            out[..., 5 + k] = part * self.sin_read
        return out

    def gram(self, around: Array | None = None) -> Array:
        """The matrix (..., 10, 10) of the quadratic form; ``around`` (..., 6) is the point whose r sets weights 1/r^2.

        Without it r = 1, which is right to within the offsets and the gain mismatch.
        """
        sums = moments.Moments(self.cos_shaft.shape[:-1], self.longest, rows=3)
        for _, part in self.chunks():
            weights = part.weights
            if around is not None:
                x, y = part.channels(around)
                inverse = 1.0 / (x * x + y * y)
                weights = inverse if weights is None else weights * inverse
            harmonics, rows = sums.piece(part.cos_shaft, part.sin_shaft)
            moments.products(part.cos_read, part.sin_read, weights, rows)
            sums.add(harmonics, rows)
        return moments.gram(sums.total)

    def channels(self, points: Array) -> tuple[Array, Array]:
        """x and y (..., n) of the model at points (..., 6)."""
        vx, vy, gain, beta, quad, zero = _unpacked(points[..., None, :])
        cos_a = np.cos(zero) * self.cos_shaft - np.sin(zero) * self.sin_shaft
        sin_b = np.cos(zero + beta) * self.sin_shaft + np.sin(zero + beta) * self.cos_shaft
        return vx + cos_a * (1.0 + quad * cos_a), gain * (vy + sin_b * (1.0 + quad * sin_b))

    def residual(self, points: Array) -> Array:
        """hm - atan2(y, x) (..., n) [rad] in (-pi, pi] at points (..., 6)."""
        out = np.empty(np.broadcast_shapes((*points.shape[:-1], 1), self.cos_shaft.shape, self.cos_read.shape))
        for rows, part in self.chunks():
            x, y = part.channels(points)
            sine, cosine = x * part.sin_read - y * part.cos_read, x * part.cos_read + y * part.sin_read
            np.arctan2(sine, cosine, out=out[..., rows])
        return out

    def linearised(self, points: Array) -> tuple[Array, Array]:
        """Residual (..., n) and the slopes of atan2(y, x) with respect to the parameters (..., 6, n)."""
        _, vy, gain, beta, quad, zero = _unpacked(points[..., None, :])
        cz, sz, cb, sb = np.cos(zero), np.sin(zero), np.cos(zero + beta), np.sin(zero + beta)
        cos_a = cz * self.cos_shaft - sz * self.sin_shaft
        sin_a = cz * self.sin_shaft + sz * self.cos_shaft
        sin_b = cb * self.sin_shaft + sb * self.cos_shaft
        cos_b = cb * self.cos_shaft - sb * self.sin_shaft
        x = points[..., VX, None] + cos_a * (1.0 + quad * cos_a)
        unscaled = vy + sin_b * (1.0 + quad * sin_b)
        y = gain * unscaled
        inverse = 1.0 / (x * x + y * y)
        to_x, to_y = -y * inverse, x * inverse
        slopes = np.empty((*x.shape[:-1], 6, x.shape[-1]))
        slopes[..., VX, :] = to_x
        slopes[..., VY, :] = gain * to_y
        slopes[..., GAIN, :] = unscaled * to_y
        slopes[..., BETA, :] = gain * cos_b * (1.0 + 2.0 * quad * sin_b) * to_y
        slopes[..., QUAD, :] = cos_a * cos_a * to_x + gain * sin_b * sin_b * to_y
        slopes[..., ZERO, :] = -sin_a * (1.0 + 2.0 * quad * cos_a) * to_x + slopes[..., BETA, :]
        residual = np.arctan2(x * self.sin_read - y * self.cos_read, x * self.cos_read + y * self.sin_read)
        return residual, slopes


def swapped_gram(gram: Array) -> Array:
    """The matrix (..., 10, 10) of the same readings with both senses swapped: some features change sign."""
    return gram * _MIRROR_FEATURES[:, None] * _MIRROR_FEATURES
