"""Orders of the turn in a column: a fit that single wild readings do not bend, and how sure its figures are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from twin.angles import Array, BoolArray
from twin.confidence import OF_MAD

_WILD = 6.0
"""Robust standard deviations beyond which a reading is left out of a fit."""
FALSE_ALARM = 1e-5
"""Probability with which a single check may find in a log without a fault what chance has made: with some thirty checks
a clean log is told of a fault in fewer than one of 1,000."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """A linear fit: coefficients (p,) with their standard errors, what is left (n,), and which rows were kept (n,)."""

    values: Array
    errors: Array
    left: Array
    kept: BoolArray

    @property
    def sigma(self) -> float:
        """Standard deviation of what is left of the rows kept."""
        free = max(int(self.kept.sum()) - self.values.size, 1)
        return float(np.sqrt(np.sum(self.left[self.kept] ** 2) / free))


def waves(angle_rad: Array, orders: Iterable[float]) -> list[Array]:
    """Cosine and sine (n,) of some orders."""
    return [wave(order * angle_rad) for order in orders for wave in (np.cos, np.sin)]


def fitted(shapes: list[Array], values: Array, *, most_wild: float = 0.5) -> Fitted:
    """Least squares of values (n,) on shapes, wild readings left out, unless they are more than this share.

    Standard errors hold for neighbours that are alike: they are widened by what the correlation of neighbouring rows
    takes from the number of readings.
    """
    design = np.stack(shapes, axis=1)
    kept: BoolArray = np.ones(values.size, dtype=bool)
    coefficients: Array = np.zeros(design.shape[1])
    left: Array = values
    for _ in range(4):
        coefficients = np.asarray(np.linalg.lstsq(design[kept], values[kept], rcond=None)[0])
        left = values - design @ coefficients
        scale = OF_MAD * float(np.median(np.abs(left)))
        now = np.abs(left) <= max(_WILD * scale, 1e-12)
        if np.array_equal(now, kept) or now.sum() <= design.shape[1] + 2 or np.mean(~now) > most_wild:
            break
        kept = now
    errors = _standard_errors(design[kept], left[kept])
    return Fitted(coefficients, errors, left, kept)


def _standard_errors(design: Array, left: Array) -> Array:
    free = max(left.size - design.shape[1], 1)
    variance = float(np.sum(left**2)) / free
    power = float(np.sum(left**2))
    alike = float(np.sum(left[1:] * left[:-1])) / power if power > 0.0 else 0.0
    alike = min(max(alike, 0.0), 0.99)
    spread = np.linalg.pinv(design.T @ design)
    found: Array = np.sqrt(np.maximum(np.diag(spread), 0.0) * variance * (1.0 + alike) / (1.0 - alike))
    return found


def amplitudes(fit: Fitted, first: int, count: int) -> tuple[Array, Array]:
    """Amplitudes (count,) of pairs of cosine and sine from a coefficient on, with their standard errors."""
    pairs = fit.values[first : first + 2 * count].reshape(count, 2)
    errors = fit.errors[first : first + 2 * count].reshape(count, 2)
    return np.hypot(*pairs.T), np.sqrt(np.mean(errors**2, axis=1))


def times_sure() -> float:
    """Standard errors beyond which a figure is no chance."""
    from scipy.stats import norm

    return float(norm.isf(FALSE_ALARM / 2.0))


def noise_floor(values: Array) -> float:
    """Standard deviation of what is white in a column (n,): the median of its spectrum, which lines do not lift."""
    if values.size < 16:
        return 0.0
    power = np.abs(np.fft.rfft(values - np.mean(values))[1:]) ** 2 / values.size
    return float(np.sqrt(np.median(power) / np.log(2.0)))


def white_noise(values: Array) -> float:
    """Standard deviation of what is not alike in neighbouring rows (n,), from third differences, robustly."""
    if values.size < 8:
        return 0.0
    third = np.diff(values, 3)
    return float(OF_MAD * np.median(np.abs(third)) / np.sqrt(20.0))
