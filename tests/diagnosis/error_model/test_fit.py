"""The fit: recovery over the whole range, what must not change it, gross errors, intervals, rivals."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from diagnosis import fit_baseline
from diagnosis.error_model.descents import starts
from diagnosis.error_model.fit import fit_equal, fit_many
from diagnosis.error_model.global_search import QUICK
from diagnosis.error_model.least_squares import descend_on_gram
from diagnosis.error_model.model import NAMES, ZERO, Readings
from diagnosis.error_model.swarm import SwarmSettings
from scenarios.commands.paper.table_2 import draw
from tests.diagnosis.cases import NOISE_RAD, measured, points, senses, turn
from tests.diagnosis.error_model.study import ratio_and_coverage
from twin.angles import Array, wrap
from twin.motion import Motion

PROFILE = settings(max_examples=35, deadline=None, derandomize=True)


def difference(one: Array, other: Array) -> Array:
    """Difference of two points (6,), the zero on the circle."""
    out = one - other
    out[ZERO] = wrap(out[ZERO])
    return out


@given(points(), senses, st.sampled_from([16, 65, 360, 2000]), st.integers(0, 2**20))
@PROFILE
def test_recovers_what_was_injected(point: Array, pair: tuple[int, int], readings: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    reference = turn(readings) + rng.uniform(-0.05, 0.05, readings)
    noise = NOISE_RAD * rng.standard_normal(readings)
    reading = wrap(measured(point, reference, *pair, noise))
    fit = fit_baseline(reference, reading, rng=rng)
    predicted = fit.chain().readings(Motion.from_angle(reference))
    np.testing.assert_allclose(wrap(reading - predicted - fit.residual_rad), 0.0, atol=1e-9)
    assert fit.settled
    if (fit.senses.sensor, fit.senses.output) != pair:
        # Only where q is too small to tell the senses apart.
        assert fit.senses.sigma < 5.0
        return
    # 2.6 half-widths of a 95 % interval are 5 standard errors.
    assert np.all(np.abs(difference(fit.point, point)) <= 2.6 * (fit.high - fit.point))


@given(points(), st.floats(-3.0, 3.0), st.integers(0, 2**20))
@PROFILE
def test_equivariance(point: Array, turned: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    reference = turn(120)
    reading = measured(point, reference, noise=NOISE_RAD * rng.standard_normal(120))

    def fitted(theta: Array, m: Array, pair: tuple[int, int]) -> Array:
        return fit_baseline(theta, m, rng=np.random.default_rng(1), senses=pair).point

    plain = fitted(reference, reading, (1, 1))
    tolerance = 1e-3 * fit_baseline(reference, reading, rng=rng, senses=(1, 1)).standard_errors
    shuffled = rng.permutation(120)
    assert np.all(np.abs(difference(fitted(reference[shuffled], reading[shuffled], (1, 1)), plain)) < tolerance)
    # The reference's zero turned: only the zero follows.
    moved = fitted(reference - turned, reading, (1, 1))
    moved[ZERO] -= turned
    assert np.all(np.abs(difference(moved, plain)) < tolerance)
    # The reference counting the other way round, or the output: nothing changes.
    assert np.all(np.abs(difference(fitted(-reference, reading, (-1, 1)), plain)) < tolerance)
    assert np.all(np.abs(difference(fitted(reference, -reading, (1, -1)), plain)) < tolerance)
    # Whole turns more or less do not count.
    whole = 2 * np.pi * rng.integers(-3, 4, 120)
    assert np.all(np.abs(difference(fitted(reference + whole, reading - whole, (1, 1)), plain)) < tolerance)


@given(points(), st.integers(0, 2**20))
@PROFILE
def test_gross_errors_do_not_spoil_the_fit(point: Array, seed: int) -> None:
    rng = np.random.default_rng(seed)
    reference = turn(360)
    reading = measured(point, reference, noise=NOISE_RAD * rng.standard_normal(360))
    clean = fit_baseline(reference, reading, rng=rng)
    bad = rng.choice(180, 9, replace=False) * 2
    reading[bad] += rng.choice([-1.0, 1.0], 9) * rng.uniform(np.radians(1.0), np.pi, 9)
    fit = fit_baseline(reference, reading, rng=rng, robust=True)
    assert set(bad) == set(np.flatnonzero(fit.outliers))
    if (fit.senses.sensor, fit.senses.output) == (clean.senses.sensor, clean.senses.output):
        assert np.all(np.abs(difference(fit.point, clean.point)) < 1.5 * clean.standard_errors)


def test_smooth_structure_is_no_gross_error() -> None:
    reference = turn(360)
    spots = 0.03 * np.exp(-0.5 * (wrap(reference - 2.0) / 0.05) ** 2)
    rng = np.random.default_rng(0)
    fit = fit_baseline(reference, reference + spots + 1e-4 * rng.standard_normal(360), rng=rng, robust=True)
    assert not fit.outliers.any()


@pytest.mark.parametrize("swarm", [None, QUICK], ids=["descents", "swarm"])
def test_widens_and_says_so(swarm: SwarmSettings | None) -> None:
    point = np.array([0.001, 0.002, 1.19, 0.001, 0.001, 0.5])
    rng = np.random.default_rng(0)
    fit = fit_baseline(turn(360), measured(point, turn(360)), rng=rng, senses=(1, 1), settings=swarm)
    assert fit.search.widened == ("gain_ratio",)
    assert fit.search.lower[2] < 1.19 < fit.search.upper[2]
    assert fit.contributions.polished_rms_rad < 1e-9
    assert (fit.search.rounds > 1) == (swarm is not None)
    np.testing.assert_allclose(fit.point, point, atol=1e-10)
    assert not fit.at_bound.any()


def test_the_swarm_searches_where_descents_do_not_agree() -> None:
    """Of a third of the turn with much noise some of them end in other minima; of a whole turn none does."""
    point, rng = np.array([0.005, 0.002, 1.01, 0.01, 0.003, 0.5]), np.random.default_rng(3)
    by = []
    for share in (1.0, 0.1):
        shaft = turn(360) * share
        read = measured(point, shaft, noise=NOISE_RAD * rng.standard_normal(360))
        found = fit_baseline(shaft, read, rng=np.random.default_rng(0), senses=(1, 1)).contributions
        by.append((found.descents_rms_rad is not None, found.swarm_rms_rad is not None, found.particles_evaluated > 0))
    assert by == [(True, False, False), (False, True, True)]


def test_the_swarm_and_the_descents_end_in_one_minimum() -> None:
    """Least squares polishes both on the readings, to 1e-5 standard errors."""
    point, rng = np.array([0.005, -0.007, 1.015, 0.01, 0.002, 1.5]), np.random.default_rng(5)
    read = measured(point, turn(360), noise=NOISE_RAD * rng.standard_normal(360))
    one, other = (
        fit_baseline(turn(360), read, rng=np.random.default_rng(0), settings=swarm) for swarm in (None, QUICK)
    )
    np.testing.assert_allclose(one.point, other.point, atol=1e-4 * np.sqrt(np.diag(one.covariance)).min())


def test_a_descent_ends_where_the_forms_digits_end() -> None:
    """Four or five passes from anywhere in the paper's range; on and on where rounding is taken for a gain."""
    point, shaft = np.array([0.005, -0.007, 1.015, 0.01, 0.002, 0.02]), turn(10_000)
    begun = starts(np.array([0.02]))[0]
    for seed in range(6):
        noise = 0.1 * NOISE_RAD * np.random.default_rng(seed).standard_normal(shaft.size)
        form = Readings.of(shaft[None], measured(point, shaft, noise=noise)[None]).gram()
        ended = descend_on_gram(np.repeat(form, len(begun), axis=0), begun, count=shaft.size)
        assert ended.settled.all()
        assert ended.passes <= 6


def test_senses_are_decided_where_q_shows() -> None:
    point = np.array([0.005, 0.002, 1.01, 0.01, 0.003, 0.5])
    rng = np.random.default_rng(0)
    for pair in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        fit = fit_baseline(turn(360), measured(point, turn(360), *pair, NOISE_RAD * rng.standard_normal(360)), rng=rng)
        assert (fit.senses.sensor, fit.senses.output) == pair
        assert fit.senses.sigma > 3.0
    point[4] = 0.0
    undecided = fit_baseline(turn(360), measured(point, turn(360), noise=NOISE_RAD * rng.standard_normal(360)), rng=rng)
    assert undecided.senses.sigma < 3.0


def test_weights_leave_rows_out() -> None:
    reference = turn(60)
    reading = measured(np.array([0.01, 0.0, 1.0, 0.0, 0.0, 0.3]), reference)
    reading[::3] += 0.5
    weights = np.ones(60)
    weights[::3] = 0.0
    fit = fit_baseline(reference, reading, rng=np.random.default_rng(0), weights=weights)
    assert fit.rms_rad < 1e-9
    assert fit.degrees_of_freedom == 34
    assert not fit.outliers.any()


def test_eight_readings_and_a_million() -> None:
    point = np.array([0.008, -0.005, 1.01, 0.005, 0.002, 1.0])
    for readings in (8, 1_000_000):
        reference = turn(readings)
        noise = NOISE_RAD * np.random.default_rng(0).standard_normal(readings)
        fit = fit_baseline(
            reference, measured(point, reference, noise=noise), rng=np.random.default_rng(0), senses=(1, 1)
        )
        assert np.all(np.abs(difference(fit.point, point)) <= 2.6 * (fit.high - fit.point))


def test_batches_agree_with_single_fits() -> None:
    cases = draw(5, np.random.default_rng(7), readings=90)
    together = fit_equal(cases.reference, cases.measured, rng=np.random.default_rng(0))
    listed = fit_many(list(zip(cases.reference, cases.measured, strict=True)), rng=np.random.default_rng(3))
    for k, fit in enumerate(together):
        alone = fit_baseline(cases.reference[k], cases.measured[k], rng=np.random.default_rng(k + 9))
        for other in (alone, listed[k]):
            assert np.all(np.abs(difference(fit.point, other.point)) < 1e-3 * fit.standard_errors)


def test_never_worse_than_least_squares() -> None:
    from scipy.optimize import least_squares

    from diagnosis.error_model.model import Readings

    cases = draw(20, np.random.default_rng(11), readings=72)
    fits = fit_equal(cases.reference, cases.measured, rng=np.random.default_rng(0), senses=(1, 1))
    for k, fit in enumerate(fits):
        readings = Readings.of(cases.reference[k], cases.measured[k])
        rival = least_squares(readings.residual, cases.points[k], xtol=1e-14, ftol=1e-14, gtol=1e-14)
        assert np.sum(fit.residual_rad**2) <= 2.0 * rival.cost * (1.0 + 1e-9)


def test_errors_meet_the_cramer_rao_bound() -> None:
    rng = np.random.default_rng(2015)
    ratio, coverage = ratio_and_coverage(draw(300, rng), rng)
    # RMS over 300 cases scatters by 1/sqrt(600) = 4 %, coverage by 1.3 %, over six parameters by no less than 0.5 %.
    np.testing.assert_allclose(ratio, 1.0, atol=0.15)
    np.testing.assert_allclose(coverage, 0.95, atol=0.045)
    assert coverage.mean() == pytest.approx(0.95, abs=0.02)


@pytest.mark.study
def test_a_thousand_cases() -> None:
    rng = np.random.default_rng(42)
    ratio, coverage = ratio_and_coverage(draw(1000, rng), rng)
    assert dict(zip(NAMES, ratio <= 1.1, strict=True)) == dict.fromkeys(NAMES, True)
    assert np.all((coverage > 0.93) & (coverage < 0.97))
