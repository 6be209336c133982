"""Spectra over the cosine basis of a record: white, first-order autoregressive and 1/f noise, and a resonance's.

In the cosine basis (DCT-II) stationary noise is very nearly independent from coefficient to coefficient, with the
variance given by its spectrum: the basis is the limit of the Karhunen-Loeve basis of first-order autoregressive noise
(N. Ahmed, T. Natarajan, K. R. Rao, IEEE Trans. Comput. C-23 (1974) 90).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from twin.angles import Array


def spectrum(
    n: int,
    *,
    correlation: float = 0.0,
    flicker_exponent: float = 0.0,
    white_share: float = 0.0,
    ringing: tuple[float, float] = (0.0, 0.0),
) -> Array:
    """Variance of each cosine coefficient of a noise of unit variance.

    Parameters
    ----------
    n : int
        Readings in the sequence.
    correlation : float
        Of first-order autoregressive noise, from one reading to the next; 0: none.
    flicker_exponent : float
        Exponent a of 1/f^a noise; 0: none. With a correlation beside it the two spectra are multiplied.
    white_share : float
        Share of the variance that is white noise beside the coloured one.
    ringing : tuple of float
        Frequency [cycles a reading] and quality of a resonance that random knocks keep ringing; frequency 0: none.
        With a correlation or 1/f noise beside it the spectra are multiplied.

    Returns
    -------
    ndarray, shape (n,)
        Spectrum of mean 1, from the lowest frequency to half the rate of the readings.
    """
    omega = np.pi * (np.arange(n) + 0.5) / n
    coloured = (1.0 - correlation**2) / (1.0 + correlation**2 - 2.0 * correlation * np.cos(omega))
    if flicker_exponent:
        coloured = coloured * (omega / np.pi) ** -flicker_exponent
    if ringing[0]:
        coloured = coloured * resonance(omega, *ringing)
    return np.asarray((1.0 - white_share) * coloured / np.mean(coloured) + white_share)


def resonance(omega: Array, frequency: float, quality: float) -> Array:
    """Spectrum over the angular frequency (n,) [rad a reading] of what a damped oscillator makes of random knocks.

    A second-order autoregression, whose two roots turn by the frequency [cycles a reading] from one reading to the next
    and fall off as an amplitude of this quality does.
    """
    radius, turn = np.exp(-np.pi * frequency / quality), 2.0 * np.pi * frequency
    near, far = (1.0 + radius**2 - 2.0 * radius * np.cos(omega + sign * turn) for sign in (-1.0, 1.0))
    return np.asarray(1.0 / (near * far))


def to_cosine(values: Array, lengths: Sequence[int] = ()) -> Array:
    """Values (..., n) of a sequence as coefficients (..., n) of its orthonormal cosine basis.

    With ``lengths`` the values are those of several sequences of these lengths, one behind the other, each with a basis
    of its own.
    """
    from scipy.fft import dct

    if len(lengths) > 1:
        return np.concatenate([to_cosine(part) for part in _split(values, lengths)], axis=-1)
    return np.asarray(dct(values, type=2, norm="ortho", axis=-1))


def to_rows(coefficients: Array, lengths: Sequence[int] = ()) -> Array:
    """Back from cosine coefficients (..., n) to the sequence (..., n), or to several of these ``lengths``."""
    from scipy.fft import idct

    if len(lengths) > 1:
        return np.concatenate([to_rows(part) for part in _split(coefficients, lengths)], axis=-1)
    return np.asarray(idct(coefficients, type=2, norm="ortho", axis=-1))


def _split(values: Array, lengths: Sequence[int]) -> list[Array]:
    """The values (..., n) of each sequence."""
    return np.split(values, np.cumsum(lengths)[:-1], axis=-1)
