"""Noise as it is: a family of spectra over the sequence of readings, from white to strongly correlated.

In the cosine basis (DCT-II) stationary noise is very nearly independent from coefficient to coefficient, with the
variance given by its spectrum (the basis is the limit of the Karhunen-Loeve basis of first-order autoregressive
noise). So whitening is a weight on each coefficient, and every spectrum of the family costs one weighted sum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.observations import Evidence
from twin.angles import Array

_CORRELATIONS = (
    (0.0, 0.0),
    (0.35, 0.0),
    (0.6, 0.0),
    (0.75, 0.0),
    (0.85, 0.0),
    (0.92, 0.0),
    (0.97, 0.0),
    (0.6, 0.5),
    (0.85, 0.5),
    (0.95, 0.5),
    (0.9, 0.8),
    (0.98, 0.8),
)
"""First-order autoregression from reading to reading, and the share of white noise beside it."""
_PINK = ((0.5, 0.0), (1.0, 0.0), (1.0, 0.3), (1.0, 0.6))
"""Exponent of 1/f noise, and the share of white noise beside it (that of an output's grid, say)."""


COLOUR_ODDS = 3.0
"""Log odds of white noise against each coloured one before a reading is seen: twenty to one."""


@dataclass(frozen=True, eq=False)
class NoiseFamily:
    """Spectra (families, n) of unit variance over the cosine coefficients, and what to call each."""

    spectra: Array
    labels: tuple[str, ...]
    correlation: tuple[tuple[float, float], ...]

    @property
    def weights(self) -> Array:
        """Inverse spectra (families, n)."""
        return np.asarray(1.0 / self.spectra)

    def cost(self, rows: int) -> Array:
        """What each member (families,) adds to minus twice the log likelihood of so many rows in use.

        The log determinant of its covariance, and the prior odds: colour is what readings must show.
        """
        odds = np.array([0.0 if label == "white" else 2.0 * COLOUR_ODDS for label in self.labels])
        return np.asarray([log_determinant(spectrum, rows) for spectrum in self.spectra] + odds)


def log_determinant(spectrum: Array, rows: int) -> float:
    """Log determinant of the covariance of so many rows in use of a sequence with this spectrum (n,).

    Masked rows take their share of it with them: left in, it would favour the steeper spectra.
    """
    return float(np.sum(np.log(spectrum))) * (rows / spectrum.size)


def noise_family(n: int) -> NoiseFamily:
    """The family for a sequence of n readings."""
    spectra, labels, correlation = [], [], []
    for phi, white in _CORRELATIONS:
        spectra.append(spectrum(n, phi=phi, white=white))
        labels.append("white" if phi == 0 else f"AR(1) {phi:g}" + _beside(white))
        correlation.append((phi, 1.0 - white))
    for alpha, white in _PINK:
        spectra.append(spectrum(n, pink=alpha, white=white))
        labels.append(f"1/f^{alpha:g}" + _beside(white))
        correlation.append((0.5 + 0.4 * alpha, 1.0 - white))
    return NoiseFamily(np.stack(spectra), tuple(labels), tuple(correlation))


def _beside(white: float) -> str:
    return f" + {white:.0%} white" if white else ""


def spectrum(n: int, *, phi: float = 0.0, pink: float = 0.0, white: float = 0.0) -> Array:
    """Spectrum (n,) of mean 1 over the cosine coefficients.

    First-order autoregression ``phi``, or 1/f noise of the exponent ``pink`` where that is given, with a share of
    ``white`` noise beside it.
    """
    omega = np.pi * (np.arange(n) + 0.5) / n
    coloured = (omega / np.pi) ** -pink if pink else (1.0 - phi**2) / (1.0 + phi**2 - 2.0 * phi * np.cos(omega))
    return np.asarray((1.0 - white) * coloured / np.mean(coloured) + white)


def to_cosine(evidence: Evidence, values: Array) -> Array:
    """Angles (..., n) over the rows as cosine coefficients (..., n); masked rows count as zero, rows by their scale."""
    return _cosine(values * (evidence.usable / evidence.scale))


def observables_to_cosine(evidence: Evidence, values: Array) -> Array:
    """Observables (..., O, n) likewise; the scale is the angle's: the radius need not be loud where the angle is."""
    out = values * evidence.usable
    out[..., 0, :] /= evidence.scale
    return _cosine(out)


def radius_to_cosine(evidence: Evidence, values: Array) -> Array:
    """Radii (..., n) likewise."""
    return _cosine(values * evidence.usable)


def _cosine(values: Array) -> Array:
    from scipy.fft import dct

    return np.asarray(dct(values, type=2, norm="ortho", axis=-1))


def to_rows(coefficients: Array) -> Array:
    """Back from cosine coefficients (..., n) to rows."""
    from scipy.fft import idct

    return np.asarray(idct(coefficients, type=2, norm="ortho", axis=-1))
