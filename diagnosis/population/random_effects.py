"""A figure over devices: its mean and its spread, each device's own uncertainty taken out.

Each estimate is the device's true figure plus an error of known size; true figures scatter about the mean with a
variance tau^2. Paule and Mandel's estimate of it makes the weighted sum of squares what is expected of it, which needs
no distribution and was among the best of sixteen in the review of Veroniki et al. The interval of the mean is that of
Hartung and Knapp, that of the spread Viechtbauer's Q profile.

References: Paule and Mandel (1982), J. Res. NBS 87, 377; DerSimonian and Laird (1986), Control. Clin. Trials 7, 177;
Hartung and Knapp (2001), Statist. Med. 20, 3875; Viechtbauer (2007), Statist. Med. 26, 37; Veroniki et al. (2016), Res.
Synth. Methods 7, 55.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.confidence import student_95

_HALVINGS = 200
"""Steps of a bisection: it ends when two numbers follow one another, long before."""


@dataclass(frozen=True, kw_only=True)
class RandomEffects:
    """Mean and spread (standard deviation of the true figures) of ``devices`` devices, with 95 % intervals."""

    mean: float
    low: float
    high: float
    spread: float
    spread_low: float
    spread_high: float
    devices: int

    @property
    def error(self) -> float:
        """Standard error of the mean, from its interval."""
        return (self.high - self.low) / (2.0 * student_95(self.devices - 1))


def random_effects(values: Array, errors: Array) -> RandomEffects:
    """Mean and spread of at least two figures (N,) with standard errors (N,)."""
    from scipy.special import chdtri

    freedom = values.size - 1
    variance = _variance_with(values, errors, float(freedom))
    weights = 1.0 / (errors**2 + variance)
    mean = float(weights @ values / weights.sum())
    squares = float(weights @ (values - mean) ** 2)
    half = student_95(freedom) * np.sqrt(squares / (freedom * weights.sum()))
    ends = [_variance_with(values, errors, float(chdtri(freedom, p))) for p in (0.025, 0.975)]
    return RandomEffects(
        mean=mean,
        low=mean - half,
        high=mean + half,
        spread=float(np.sqrt(variance)),
        spread_low=float(np.sqrt(ends[0])),
        spread_high=float(np.sqrt(ends[1])),
        devices=values.size,
    )


def _variance_with(values: Array, errors: Array, wanted: float) -> float:
    """The variance between devices at which the weighted sum of squares is the wanted one; 0 where none is needed."""
    scale = max(float(np.var(values)), float(np.min(errors)) ** 2)

    def squares(variance: float) -> float:
        weights = 1.0 / (errors**2 + variance)
        return float(weights @ (values - weights @ values / weights.sum()) ** 2)

    if scale == 0.0 or squares(0.0) <= wanted:
        return 0.0
    low, high = 0.0, scale
    while squares(high) > wanted:
        high *= 2.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if squares(middle) > wanted else (low, middle)
    return 0.5 * (low + high)
