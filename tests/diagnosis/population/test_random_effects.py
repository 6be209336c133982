"""Mean and spread over devices, held against published figures and against what was put in."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.population.random_effects import random_effects

TRIALS = (
    *((4, 119, 11, 128), (6, 300, 29, 274), (3, 228, 11, 209), (62, 13536, 248, 12619), (33, 5036, 47, 5761)),
    *((180, 1361, 372, 1079), (8, 2537, 10, 619), (505, 87886, 499, 87892), (29, 7470, 45, 7232)),
    *((17, 1699, 65, 1600), (186, 50448, 141, 27197), (5, 2493, 3, 2338), (27, 16886, 29, 17825)),
)
"""The thirteen trials of Colditz et al. (1994), on which the literature tries such estimates: ill and well, twice."""


def test_published_example() -> None:
    """The interval of the variance that Viechtbauer's method gives there, 0.1197 to 1.1115, and the mean of -0.71."""
    a, b, c, d = np.array(TRIALS, dtype=np.float64).T
    values = np.log(a / (a + b) / (c / (c + d)))
    errors = np.sqrt(1.0 / a - 1.0 / (a + b) + 1.0 / c - 1.0 / (c + d))
    found = random_effects(values, errors)
    assert found.spread_low**2 == pytest.approx(0.1197, abs=1e-4)
    assert found.spread_high**2 == pytest.approx(1.1115, abs=1e-4)
    assert found.mean == pytest.approx(-0.7145, abs=2e-3)
    weights = 1.0 / (errors**2 + found.spread**2)
    assert weights @ (values - found.mean) ** 2 == pytest.approx(12.0, rel=1e-9)


def test_devices_own_errors_are_taken_out() -> None:
    """Errors twice as large as the spread: the spread comes back, and intervals hold it and the mean in 95 %."""
    rng = np.random.default_rng(1)
    means, spreads = 0, 0
    for _ in range(200):
        errors = rng.uniform(0.5, 2.0, 100)
        found = random_effects(3.0 + 0.6 * rng.standard_normal(100) + errors * rng.standard_normal(100), errors)
        means += found.low <= 3.0 <= found.high
        spreads += found.spread_low <= 0.6 <= found.spread_high
    # Binomial: 190 of 200, four standard deviations are 12.
    assert means >= 178
    assert spreads >= 178


def test_no_spread_is_said_to_be_none() -> None:
    values = np.array([1.0, 1.1, 0.9, 1.05])
    found = random_effects(values, np.full(4, 1.0))
    assert found.spread == 0.0
    assert found.low < 1.0 < found.high


def test_values_without_errors_are_averaged() -> None:
    values = np.array([1.0, 2.0, 4.0, 5.0])
    found = random_effects(values, np.full(4, 1e-9))
    assert found.mean == pytest.approx(3.0)
    assert found.spread == pytest.approx(np.std(values, ddof=1))
