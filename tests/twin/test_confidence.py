"""Intervals of figures that several explanations tell."""

from __future__ import annotations

import numpy as np
import pytest

from twin.confidence import Z95, mixed_95


def test_one_explanation_is_its_own_interval() -> None:
    assert mixed_95([(1.0, 2.0, 1.0, 4.0)]) == pytest.approx((1.0, 4.0))
    assert mixed_95([(1.0, 2.0, 1.0, 4.0), (0.0, 9.0, 8.0, 10.0)]) == pytest.approx((1.0, 4.0), abs=1e-6)


def test_what_is_as_likely_holds_half_of_what_is_drawn() -> None:
    """The ends are the quantiles of draws from either: of 200,000 within 1 % of their width."""
    rng = np.random.default_rng(1)
    drawn = np.where(rng.random(200_000) < 0.25, rng.normal(5.0, 2.0, 200_000), rng.normal(0.0, 1.0, 200_000))
    told = [(3.0, 0.0, -Z95, Z95), (1.0, 5.0, 5.0 - 2.0 * Z95, 5.0 + 2.0 * Z95)]
    assert mixed_95(told) == pytest.approx(np.quantile(drawn, [0.025, 0.975]), abs=0.1)


def test_a_figure_that_is_known_exactly_has_no_width() -> None:
    assert mixed_95([(1.0, 2.0, 2.0, 2.0)]) == (2.0, 2.0)


def test_what_is_improbable_opens_no_end() -> None:
    assert mixed_95([(1.0, 0.0, -1.0, 1.0), (1e-9, 0.0, -np.inf, np.inf)]) == pytest.approx((-1.0, 1.0), abs=1e-6)
    assert mixed_95([(1.0, 0.0, -1.0, 1.0), (1.0, 0.0, -np.inf, np.inf)]) == (-np.inf, np.inf)
