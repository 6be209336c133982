"""The sums that a descent takes from a pass over the readings, against the slopes of each reading."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import fit_baseline
from diagnosis.error_model import least_squares
from diagnosis.error_model.model import Readings
from tests.diagnosis.cases import NOISE_RAD, measured, turn
from twin.angles import Array

POINTS = np.array([[0.1, -0.05, 1.3, 0.08, 0.04, 0.7], [-0.02, 0.2, 0.6, -0.05, -0.03, 2.9]])
COUNT = 40_003
"""More than two pieces, the last one short."""


def readings(rng: np.random.Generator, weights: Array | None) -> Readings:
    """Two sweeps near the points, all angles at random."""
    shaft = rng.uniform(-9.0, 9.0, (2, COUNT))
    read = np.stack([measured(point, angle) for point, angle in zip(POINTS, shaft, strict=True)])
    return Readings.of(shaft, read + NOISE_RAD * rng.standard_normal(shaft.shape), weights=weights)


@pytest.mark.parametrize("weighted", [False, True])
def test_a_pass_is_the_sums_over_the_slopes(weighted: bool) -> None:
    rng = np.random.default_rng(0)
    given = readings(rng, rng.uniform(0.0, 2.0, (2, COUNT)) if weighted else None)
    residual, slopes = given.linearised(POINTS)
    weights = np.ones((2, COUNT)) if given.weights is None else given.weights
    found = least_squares.on_readings(given)(POINTS)
    curvature = np.einsum("bin,bjn,bn->bij", slopes, slopes, weights)
    np.testing.assert_allclose(found.curvature, curvature, atol=1e-13 * COUNT)
    np.testing.assert_allclose(found.descent, np.einsum("bin,bn,bn->bi", slopes, residual, weights), atol=1e-14 * COUNT)
    np.testing.assert_allclose(found.cost, np.einsum("bn,bn->b", residual**2, weights), rtol=1e-12)
    np.testing.assert_allclose(found.residual, residual, atol=1e-14)
    again = least_squares.on_readings(given)(POINTS, found.curvature)
    assert again.curvature is found.curvature
    np.testing.assert_allclose(again.descent, found.descent, rtol=1e-12)


def test_the_form_is_the_sums_over_the_features() -> None:
    rng = np.random.default_rng(1)
    given = readings(rng, rng.uniform(0.0, 2.0, (2, COUNT)))
    features = given.features()
    assert given.weights is not None
    product = np.einsum("bni,bnj,bn->bij", features, features, given.weights)
    np.testing.assert_allclose(given.gram(), product, atol=1e-14 * COUNT)


def test_the_interval_is_that_of_the_curvature_where_the_descent_ends() -> None:
    """Also where the exact minimum is far from that of the form, as an error that the model lacks makes it."""
    shaft = turn(360)
    read = measured(POINTS[0], shaft) + 0.3 * np.sin(3.0 * shaft)
    fit = fit_baseline(shaft, read, rng=np.random.default_rng(0), senses=(1, 1))
    _, slopes = Readings.of(shaft, read).linearised(fit.point)
    covariance = fit.sigma_rad**2 * np.linalg.inv(slopes @ slopes.T)
    np.testing.assert_allclose(fit.covariance, covariance, rtol=1e-5, atol=1e-12)
    predicted = Readings.of(shaft, read).residual(fit.point)
    np.testing.assert_allclose(fit.residual_rad, predicted, atol=1e-13)
