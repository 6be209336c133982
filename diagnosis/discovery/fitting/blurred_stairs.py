"""Stairs behind noise: what readings are on average, and how they scatter, where their noise is rounded with them.

A stair function is sampled once on the circle and convolved with the noise's density there, so that the expected
reading is a smooth function of the angle: a fit whose expectation is made of few sample points moves over steps of
its own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from twin.angles import TAU, Array, wrap
from twin.effect import Effect, Parameters
from twin.motion import Motion

_POINTS_A_BLUR = 8
"""Points on the circle in one RMS of the noise: straight lines between them leave 1/512 of the curve."""
_FEWEST_POINTS, _MOST_POINTS = 2**12, 2**20
"""On the circle; noise below 3e-4 deg is blurred as if it were that."""
_PIECE = 4096
"""Points that run through an effect side by side."""

Stair = tuple[Callable[..., Array], tuple[tuple[str, tuple[float, ...]], ...]]
"""An effect's forward function and the values of its parameters."""


@dataclass(frozen=True, eq=False)
class BlurredStairs:
    """How far the mean reading is from the angle [rad], and its variance [rad^2], at points around the circle.

    (points + 1,) each, the first at half a step from the angle 0, and once more at the end.
    """

    mean: Array
    variance: Array

    def at(self, angle: Array) -> tuple[Array, Array]:
        """Mean away from the angle [rad], and variance [rad^2], for angles [rad] of any shape."""
        points = self.mean.size - 1
        place = (angle * (points / TAU) - 0.5) % points
        low = np.minimum(place.astype(np.int64), points - 1)
        share = place - low
        mean, variance = ((1.0 - share) * one[low] + share * one[low + 1] for one in (self.mean, self.variance))
        return np.asarray(mean), np.asarray(variance)


def blurred_stairs(active: Sequence[tuple[Effect, Parameters]], blur: float) -> BlurredStairs:
    """The stairs of effects on the angle, one after the other, behind Gaussian noise of RMS ``blur`` [rad]."""
    stairs = tuple((effect.forward, _frozen(values)) for effect, values in active)
    points = 2 ** int(np.ceil(np.log2(TAU * _POINTS_A_BLUR / blur)))
    return _convolved(stairs, min(max(points, _FEWEST_POINTS), _MOST_POINTS), blur)


def _frozen(values: Parameters) -> tuple[tuple[str, tuple[float, ...]], ...]:
    return tuple((name, tuple(np.ravel(value).tolist())) for name, value in sorted(values.items()))


@lru_cache(maxsize=4)
def _convolved(stairs: tuple[Stair, ...], points: int, blur: float) -> BlurredStairs:
    # With noise v ahead of the stairs a reading is off by s(a + v) + v; E[s(a + v) v] is blur^2 times the slope of the
    # mean (Stein's lemma).
    away = _sampled(stairs, points)
    order = np.arange(points // 2 + 1)
    density = np.exp(-0.5 * (order * blur) ** 2)
    spectrum = np.fft.rfft(away) * density
    mean = np.fft.irfft(spectrum, points)
    slope = np.fft.irfft(1j * order * spectrum, points)
    square = np.fft.irfft(np.fft.rfft(away**2) * density, points)
    variance = np.maximum(square - mean**2 + blur**2 * (1.0 + 2.0 * slope), 0.0)
    return BlurredStairs(np.append(mean, mean[0]), np.append(variance, variance[0]))


@lru_cache(maxsize=2)
def _sampled(stairs: tuple[Stair, ...], points: int) -> Array:
    """What the stairs add to the angle (points,) [rad] around the circle."""
    # Half a step from 0: no edge of a word of whole bits lies on a point.
    angle = ((np.arange(points) + 0.5) * (TAU / points)).reshape(-1, 1, _PIECE)
    rest = Motion.from_angle(np.zeros(_PIECE))
    signal = angle
    for forward, values in stairs:
        numbers = {name: own[0] if len(own) == 1 else np.array(own) for name, own in values}
        signal = forward(signal, rest, numbers, None)
    return np.asarray(wrap(signal - angle).ravel())
