"""Groups of coefficients scatter as the readings say, and stay where they say nothing."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.spin.variance_components import drawn

GROUP = np.arange(2, 202)


def problem(scatter: float, *, told: float) -> tuple[np.ndarray, np.ndarray]:
    """Normal equations of two free coefficients and two hundred that scatter, each read with the noise 1/told."""
    rng = np.random.default_rng(4)
    truth = np.concatenate([[1.0, -1.0], scatter * rng.standard_normal(200)])
    weight = np.full(202, told**2)
    return np.diag(weight), weight * truth + told * rng.standard_normal(202)


def test_a_scatter_is_found_from_far_off() -> None:
    """Of 200 coefficients the standard deviation is known to a twentieth."""
    normal, gradient = problem(0.3, told=10.0)
    for start in (30.0, 0.05):
        found = drawn(normal, gradient, 1.0, groups=[GROUP], sd=np.concatenate([[np.inf] * 2, np.full(200, start)]))
        assert found.sd[GROUP] == pytest.approx(0.3, rel=0.2)
        assert np.mean(found.told[GROUP]) == pytest.approx(0.9, abs=0.05)


def test_what_no_reading_tells_stays_where_it_set_out() -> None:
    normal, gradient = problem(0.3, told=1e-4)
    found = drawn(normal, gradient, 1.0, groups=[GROUP], sd=np.concatenate([[np.inf] * 2, np.full(200, 2.0)]))
    assert found.sd[GROUP] == pytest.approx(2.0)
    assert np.all(found.told[GROUP] < 0.01)
