"""The noise of a bench as an autoregression."""

from __future__ import annotations

import numpy as np

from diagnosis.population.noise import autoregression, whitened
from twin.angles import Array


def coloured(rng: np.random.Generator, n: int, coefficient: float) -> Array:
    values = rng.standard_normal(n)
    for k in range(1, n):
        values[k] += coefficient * values[k - 1]
    return values


def test_colour_comes_back_and_is_taken_out() -> None:
    rng = np.random.default_rng(2)
    found = autoregression([coloured(rng, 700, 0.8) for _ in range(20)])
    assert found.size
    assert abs(found.sum() - 0.8) < 0.03
    left = np.concatenate([whitened(coloured(rng, 700, 0.8), found) for _ in range(20)])
    # The correlation of 14,000 independent values is 0 +- 0.0085.
    assert abs(left[1:] @ left[:-1] / (left @ left)) < 0.034


def test_white_noise_is_left_as_it_is() -> None:
    rng = np.random.default_rng(3)
    residuals = [rng.standard_normal(700) for _ in range(20)]
    assert autoregression(residuals).size == 0
    np.testing.assert_array_equal(whitened(residuals[0], np.zeros(0)), residuals[0])


def test_structure_of_one_device_is_no_noise() -> None:
    """A step as large as five sigma in one of twenty devices; alone it passes for colour."""
    rng = np.random.default_rng(4)
    residuals = [rng.standard_normal(700) for _ in range(20)]
    residuals[7] = residuals[7] + 5.0 * np.sign(np.arange(700) - 349.5)
    assert autoregression(residuals).size == 0
    assert autoregression(residuals[7:8]).size > 0
