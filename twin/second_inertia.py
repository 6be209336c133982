"""A second inertia that a belt or a coupling ties to the rotor: what a torque does to a shaft that is not of one piece.

Behind a spring and a damper the second inertia swings by itself at the frequency w and, against the rotor, at the
resonance w sqrt(1 + m), m being its share of the rotor's inertia. Against a rotor of one piece, of both inertias, the
shaft answers at s by

    G(s) = (1 + 2 z s/w + s^2/w^2) / (1 + 2 z s/w + s^2/(w^2 (1 + m))),

as much where it turns slowly, next to nothing at w, by far more at the resonance, and 1 + m as much beyond (J. P. Den
Hartog, Mechanical Vibrations (1956), on the dynamic absorber). Torque and sensor are on the same side of the spring: of
a sensor on the other one, the response has no numerator's zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from twin.angles import Array

ComplexArray = npt.NDArray[np.complex128]
_BLOCK = 20.0
"""Decay, in natural logarithms, that is worked out in one piece: beyond it nothing of a swing is left."""
_SERIES = 1e-3
"""Exponents below which the series is used: what it leaves out is less than rounding makes of the quotients."""
CHANGE = 1e-3
"""Of the logarithms of a second inertia's attributes, by which slopes are taken."""


@dataclass(frozen=True)
class SecondInertia:
    """What is tied to the rotor.

    Attributes
    ----------
    resonance_rad_s : float
        Angular frequency [rad/s] at which rotor and second inertia swing against each other.
    damping : float
        Of the second inertia behind a held rotor, as a share of the critical one.
    share : float
        Its inertia over the rotor's.
    """

    resonance_rad_s: float
    damping: float
    share: float

    @classmethod
    def of(cls, logarithms: Array) -> SecondInertia:
        """From the logarithms (3,) of its attributes."""
        return cls(*np.exp(logarithms).tolist())

    @property
    def pole(self) -> complex:
        """The decaying swing goes as exp(pole t) [1/s]."""
        dies = self.damping * float(np.sqrt(1.0 + self.share)) * self.resonance_rad_s
        return complex(-dies, float(np.sqrt(max(self.resonance_rad_s**2 - dies**2, 0.0))))

    @property
    def residue(self) -> complex:
        """Of the response at the pole [1/s]."""
        held = self.resonance_rad_s / float(np.sqrt(1.0 + self.share))
        pole = self.pole
        top = 1.0 + 2.0 * self.damping * pole / held + (pole / held) ** 2
        return complex(top * self.resonance_rad_s**2 / (pole - pole.conjugate()))


@dataclass(frozen=True, eq=False)
class Tied:
    """A second inertia as readings tell it, with the covariance (3, 3) of the logarithms of its attributes."""

    second: SecondInertia
    covariance: Array

    @property
    def logarithms(self) -> Array:
        """Of resonance, damping and share (3,)."""
        return np.log([self.second.resonance_rad_s, self.second.damping, self.second.share])

    def scattered(self) -> tuple[tuple[SecondInertia, float], ...]:
        """It, changed a little along each of three ways that are told independently.

        And what part of the change one standard deviation is.
        """
        size, turned = np.linalg.eigh(self.covariance)
        return tuple(
            (SecondInertia.of(self.logarithms + CHANGE * way), float(np.sqrt(max(one, 0.0))) / CHANGE)
            for one, way in zip(size, turned.T, strict=True)
        )


@dataclass(frozen=True, eq=False)
class Behind:
    """A second inertia, and the times (n,) [s] of a shaft's angles, in stretches one behind the other."""

    second: SecondInertia
    time_s: Array
    stretches: Sequence[slice]

    def carried(self, size: ComplexArray, order: float, *, shaft_rad: Array, speed_rad_s: Array) -> ComplexArray:
        """Of a torque that turns a rotor of one piece by ``size`` e^(i order angle), what it turns this shaft by (n,).

        Between two readings size and speed change evenly. Each stretch begins in its steady state: a swing that was
        there before is not told, and dies away.
        """
        out = np.empty(size.size, dtype=np.complex128)
        pole, residue = self.second.pole, self.second.residue
        for rows in self.stretches:
            own, angle, time = size[rows], shaft_rad[rows], self.time_s[rows]
            turning = np.asarray(1j * order * speed_rad_s[rows], dtype=np.complex128)
            swings = (pole, residue), (pole.conjugate(), residue.conjugate())
            (near, at_near), (far, at_far) = swings if turning[0].imag > 0.0 else swings[::-1]
            # A swing the other way round is never near its resonance: it follows at once.
            swing = at_near * self._driven(own, order * angle, turning, time, near) + at_far * own / (turning - far)
            out[rows] = ((1.0 + self.second.share) * own + swing) * np.exp(1j * order * angle)
        return out

    @staticmethod
    def _driven(size: ComplexArray, phase: Array, turning: ComplexArray, time_s: Array, pole: complex) -> ComplexArray:
        """The solution h (n,) of h' = (pole - i phase') h + size, by exponentials from reading to reading."""
        step = np.diff(time_s)
        grown = pole * step - 1j * np.diff(phase)
        even, rising = _weights(grown)
        forced = step * (size[:-1] * even + np.diff(size) * rising)
        total = np.concatenate([[0.0], np.cumsum(grown)])
        out = np.empty(size.size, dtype=np.complex128)
        out[0] = size[0] / (turning[0] - pole)
        first = 0
        while first < size.size - 1:
            # Within a block the exponentials stay far from the ends of the numbers' range.
            last = int(np.searchsorted(-total.real, _BLOCK - total.real[first], side="right")) - 1
            last = min(max(last, first + 1), size.size - 1)
            factor = np.exp(total[first + 1 : last + 1] - total[first])
            if last == first + 1:
                out[last] = factor[0] * out[first] + forced[first]
            else:
                out[first + 1 : last + 1] = factor * (out[first] + np.cumsum(forced[first:last] / factor))
            first = last
        return out


def _weights(exponent: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Integrals over u from 0 to 1 of exp(exponent (1 - u)), and of u times it."""
    small = np.abs(exponent) < _SERIES
    safe = np.where(small, 1.0, exponent)
    grown = np.exp(safe)
    even = np.where(small, 1.0 + exponent / 2.0 + exponent**2 / 6.0, (grown - 1.0) / safe)
    rising = np.where(small, 0.5 + exponent / 6.0 + exponent**2 / 24.0, (grown - 1.0 - safe) / safe**2)
    return even, rising
