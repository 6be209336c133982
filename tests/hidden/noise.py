"""Reading noise: white, correlated from reading to reading, 1/f, or shared by repeats at one angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Noise:
    """A stationary process in row order."""

    kind: str
    """white, ar1, pink or jig (every angle has one error that all its repeats share)."""
    sigma_deg: float
    correlation: float = 0.0
    """From one reading to the next, for ar1."""
    repeats: int = 1

    def sample(self, rng: np.random.Generator, rows: int) -> Array:
        """Angle noise in degrees, shape (rows,)."""
        unit: Array = rng.standard_normal(rows)
        if self.kind == "ar1":
            unit = _coloured(unit, self.correlation)
        elif self.kind == "pink":
            unit = np.fft.irfft(np.fft.rfft(unit) * _pink_gain(rows), rows)
        elif self.kind == "jig":
            shared = np.repeat(rng.standard_normal(-(-rows // self.repeats)), self.repeats)[:rows]
            unit = 0.95 * shared + np.sqrt(1 - 0.95**2) * unit
        return self.sigma_deg * unit

    def whiten(self, columns: Array) -> Array:
        """Columns of shape (rows, k) [deg] in units of independent standard deviations."""
        rows = len(columns)
        if self.kind == "ar1":
            innovation: Array = columns[1:] - self.correlation * columns[:-1]
            return innovation / (self.sigma_deg * float(np.sqrt(1 - self.correlation**2)))
        if self.kind == "pink":
            gain = _pink_gain(rows)[:, None]
            spectrum = np.fft.rfft(columns, axis=0)
            # the mean has no share in the noise and all its weight in the zero, which is fitted
            flat = np.divide(spectrum, gain, out=np.zeros_like(spectrum), where=gain > 0)
            return np.asarray(np.fft.irfft(flat, rows, axis=0) / self.sigma_deg)
        if self.kind == "jig":
            angles = columns[: rows - rows % self.repeats].reshape(-1, self.repeats, columns.shape[1])
            return np.asarray(angles.mean(axis=1) / self.sigma_deg)
        return columns / self.sigma_deg


def _coloured(white: Array, correlation: float) -> Array:
    """First-order autoregression of unit variance, started in its steady state."""
    if len(white) == 0:
        return white
    shaped = white * np.sqrt(1 - correlation**2)
    shaped[0] = white[0]
    reach = min(len(white), int(np.ceil(np.log(1e-9) / np.log(correlation))))
    return np.convolve(shaped, correlation ** np.arange(reach))[: len(white)]


def _pink_gain(rows: int) -> Array:
    """Gain 1/sqrt(f) of a spectrum for unit total variance, no mean; shape (rows // 2 + 1,)."""
    index = np.arange(rows // 2 + 1, dtype=float)
    gain = np.zeros_like(index)
    gain[1:] = index[1:] ** -0.5
    weight = np.full_like(index, 2.0)
    if rows % 2 == 0:
        weight[-1] = 1.0
    return gain / float(np.sqrt(np.sum(weight * gain**2) / rows))


def choose(rng: np.random.Generator, *, bench: str, repeats: int) -> Noise:
    """The noise of a bench."""
    if bench == "easy":
        return Noise("white", float(rng.uniform(0.01, 0.03)))
    sigma = float(rng.uniform(0.015, 0.04))
    if repeats > 1:
        return Noise("jig", sigma, repeats=repeats)
    if rng.random() < 0.25:
        return Noise("pink", sigma)
    return Noise("ar1", sigma, float(rng.uniform(0.6, 0.9)))
