"""The change point: what is put in comes out, and the interval holds it as often as it says."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.factors.change_point import change_point

SERIES = 300


@pytest.mark.parametrize(("shape", "size"), [("step", 2.0), ("step", 4.0), ("ramp", 8.0), ("ramp", 16.0)])
def test_interval_holds_the_change(shape: str, size: float) -> None:
    """In 95 % of 300 series give or take three standard errors; it holds more where the starts are few and coarse."""
    rng = np.random.default_rng(0)
    n, first = 40, 18
    since = np.maximum(np.arange(n) - first + 1.0, 0.0)
    course = size * (since > 0.0 if shape == "step" else since / since[-1])
    found = [change_point(course + rng.standard_normal(n)) for _ in range(SERIES)]
    held = np.mean([one.low <= first <= one.high for one in found])
    assert held > 0.95 - 3.0 * np.sqrt(0.95 * 0.05 / SERIES)
    # A wide interval would hold it too: this one leaves out most of the starts.
    assert np.median([one.high - one.low for one in found]) < n / 2
    assert np.mean([one.shape == shape for one in found]) > 0.8
    # The size of either half of the series has a standard error of sqrt(2 / 20) or, of a ramp's end, about twice that.
    assert np.median([one.size for one in found]) == pytest.approx(size, abs=0.65)


def test_a_change_without_noise_is_found_exactly() -> None:
    found = change_point(np.array([1.0] * 6 + [3.0] * 4))
    assert (found.first, found.low, found.high, found.shape) == (6, 6, 6, "step")
    assert found.size == pytest.approx(2.0)
    assert change_point(np.concatenate([np.zeros(5), -np.arange(1.0, 6.0)])).size == pytest.approx(-5.0)


def test_scale_and_level_do_not_matter() -> None:
    values = np.random.default_rng(1).standard_normal(20) + 3.0 * (np.arange(20) > 11)
    one, other = change_point(values), change_point(1e-6 * values + 1.0)
    assert (one.first, one.low, one.high, one.shape) == (other.first, other.low, other.high, other.shape)


def test_values_that_are_all_alike_have_no_preferred_start() -> None:
    found = change_point(np.full(12, 0.3))
    assert found.high - found.low >= 0.9 * 9
