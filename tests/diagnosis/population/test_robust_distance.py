"""How far devices stand from the rest."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import kstest

from diagnosis.population.robust_distance import rest_of

MIXED = np.array([[1.0, 0.0, 0.0], [0.9, 0.5, 0.0], [-0.4, 0.2, 2.0]])


def test_normal_devices_have_the_distances_of_chi_squared() -> None:
    values = np.random.default_rng(5).standard_normal((2000, 3)) @ MIXED.T + [3.0, -1.0, 10.0]
    squares = rest_of(values).squares(values)
    # The largest deviation of 2,000 draws from their distribution exceeds 0.0365 in one of a hundred.
    assert kstest(squares, "chi2", args=(3,)).statistic < 0.0365


def test_odd_devices_do_not_widen_the_rest() -> None:
    rng = np.random.default_rng(6)
    values = rng.standard_normal((400, 3)) @ MIXED.T
    odd = values.copy()
    odd[:40] += 30.0
    plain, robust = rest_of(values[40:]), rest_of(odd)
    # Ten per cent of outliers: centre within half a sigma, scatter within a quarter.
    np.testing.assert_allclose(robust.centre, plain.centre, atol=0.5)
    assert np.sqrt(np.diagonal(robust.covariance)) == pytest.approx(np.sqrt(np.diagonal(plain.covariance)), rel=0.25)
    assert robust.squares(odd)[:40].min() > 100.0


def test_a_figure_that_all_have_alike_is_no_distance() -> None:
    values = np.random.default_rng(7).standard_normal((100, 2))
    values[:, 1] = 4.0
    squares = rest_of(values).squares(values)
    assert np.isfinite(squares).all()
    assert squares.max() < 25.0
