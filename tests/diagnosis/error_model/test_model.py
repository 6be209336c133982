"""The reduced error model against the twin, against itself in linear form, and against finite differences."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from diagnosis.error_model import model
from diagnosis.error_model.model import Readings
from tests.diagnosis.cases import NOISE_RAD, measured, point_of, points, senses, turn
from twin.angles import Array, wrap
from twin.chain import Chain
from twin.motion import Motion


@given(points(), senses)
@settings(max_examples=30, deadline=None)
def test_is_the_twin(point: Array, pair: tuple[int, int]) -> None:
    reference = turn(40)
    chain = Chain(values=model.twin_values(point), sensor_sense=pair[0], output_sense=pair[1])
    readings = chain.readings(Motion.from_angle(reference))
    np.testing.assert_allclose(wrap(readings - measured(point, reference, *pair)), 0.0, atol=1e-12)
    back = point_of(chain.values)
    np.testing.assert_allclose(back, point, atol=1e-12)


@given(points(), points(), senses)
@settings(max_examples=30, deadline=None)
def test_quadratic_form_is_the_sum_of_squared_sines(truth: Array, tried: Array, pair: tuple[int, int]) -> None:
    reference = turn(50)
    readings = Readings.of(
        reference, measured(truth, reference, *pair), sensor_sense=float(pair[0]), output_sense=float(pair[1])
    )
    gram = readings.gram(around=tried)
    form = model.cost(model.coefficients(tried)[None], model.factor(gram))[0]
    np.testing.assert_allclose(form, np.sum(np.sin(readings.residual(tried)) ** 2), rtol=1e-9, atol=1e-12)
    swapped = readings.oriented(np.array(True)[None])
    np.testing.assert_allclose(model.swapped_gram(readings.gram()), swapped.gram(), atol=1e-9)


@given(points())
@settings(max_examples=20, deadline=None)
def test_slopes_are_the_differences(point: Array) -> None:
    readings = Readings.of(turn(30), turn(30))
    _, slopes = readings.linearised(point)
    coefs = model.coefficient_slopes(point)
    for k, step in enumerate(1e-6 * np.eye(6)):
        moved = -wrap(readings.residual(point + step) - readings.residual(point - step)) / 2e-6
        np.testing.assert_allclose(slopes[k], moved, atol=2e-8)
        by_hand = (model.coefficients(point + step) - model.coefficients(point - step)) / 2e-6
        np.testing.assert_allclose(coefs[:, k], by_hand, atol=2e-8)


@given(st.integers(1, 4), st.integers(8, 200))
@settings(max_examples=15, deadline=None)
def test_batch_is_a_loop_and_chunks_do_not_show(batch: int, readings: int) -> None:
    rng = np.random.default_rng(readings)
    reference = rng.uniform(-7.0, 7.0, (batch, readings))
    together = Readings.of(reference, reference + NOISE_RAD * rng.standard_normal(reference.shape))
    for k in range(batch):
        alone = together.sweeps(np.array([k]))
        np.testing.assert_allclose(together.gram()[k], alone.gram()[0], atol=1e-9)
    long = np.tile(reference[0], 400)
    np.testing.assert_allclose(
        Readings.of(long, long).gram(), 400 * Readings.of(reference[0], reference[0]).gram(), rtol=1e-9
    )


def test_swapped_senses_mirror_the_point_where_q_is_zero() -> None:
    point = np.array([0.02, -0.03, 1.1, 0.04, 0.0, 1.2])
    reference = turn(60)
    readings = Readings.of(reference, measured(point, reference))
    swapped = readings.oriented(np.array([True]))
    np.testing.assert_allclose(swapped.residual(model.mirrored(point)), 0.0, atol=1e-12)
