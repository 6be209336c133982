"""The figures of one device: held against what was put in, over the devices of a batch."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2

from diagnosis.population.device import Question, estimates
from tests.diagnosis.population.batches import clean, looked
from tests.hidden.fleets.generator import Plan
from tests.hidden.fleets.study import sweeps_of
from tests.hidden.noise import Noise
from twin.sweep import Sweep


def test_errors_are_what_estimates_scatter_by() -> None:
    """A hundred candidates on sixty devices without a cause: their mean square in errors is 1 to 5 sigma of 11,000."""
    _, found, _ = clean()
    arrays = found.batch.arrays
    scores = arrays["candidate"] / arrays["candidate_error"][..., None]
    known = scores[np.isfinite(scores)]
    assert known.size > 10_000
    assert np.mean(known**2) == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / known.size))


def test_halves_agree_by_chance_alone() -> None:
    """The mean product of two halves has no bias by the noise; that of the whole with itself has."""
    _, found, _ = clean()
    arrays = found.batch.arrays
    product = np.prod(arrays["candidate_halves"], axis=1) / arrays["candidate_error"][..., None] ** 2
    known = product[np.isfinite(product)]
    assert abs(np.mean(known)) < 5.0 * np.std(known) / np.sqrt(known.size)
    assert np.mean(known) < 0.2


def test_halves_agree_by_chance_in_coloured_noise_too() -> None:
    _, found = looked(Plan(count=40, noise=Noise("ar1", 0.02, 0.8)), seed=12)
    assert found.batch.question.noise
    arrays = found.batch.arrays
    scores = arrays["candidate"] / arrays["candidate_error"][..., None]
    known = scores[np.isfinite(scores)]
    assert np.mean(known**2) == pytest.approx(1.0, abs=0.06)
    product = np.prod(arrays["candidate_halves"], axis=1) / arrays["candidate_error"][..., None] ** 2
    assert abs(np.nanmean(product)) < 5.0 * np.nanstd(product) / np.sqrt(np.count_nonzero(np.isfinite(product)))


def test_what_is_fitted_along_is_beside_all_else() -> None:
    """Two causes of one order's neighbourhood: the size put in comes back where both are fitted."""
    template, _, _ = clean()
    sweeps = sweeps_of(Plan(count=12, cause="hysteresis", strength_deg=0.05, spread=0.0), seed=13)
    places = [k for k, one in enumerate(template.question.candidates) if one.effect == "hysteresis"]
    question = Question(candidates=template.question.candidates, present=(places[0],))
    found = estimates(sweeps, question, rng=np.random.default_rng(0))
    assert found["fitted"].shape == (12, 7)
    assert np.all(found["fitted"][:, 6] > 0.03)
    # What is fitted is not asked for again.
    assert np.isnan(found["candidate_error"][:, places[0]]).all()
    assert np.isfinite(found["candidate_error"][:, places[1]]).all()


def test_a_device_of_few_readings_is_no_estimate() -> None:
    template, _, _ = clean()
    sweep = Sweep.from_columns({"reference_deg": np.arange(24.0) * 15.0, "measured_deg": np.arange(24.0) * 15.0})
    found = estimates([sweep], template.question, rng=np.random.default_rng(0))
    assert found["rows"][0] == 24.0
    assert np.isnan(found["fitted"]).all()


def test_a_device_seen_over_a_part_of_the_turn_is_no_estimate() -> None:
    """Readings over 280 of 360 deg leave factors of order 3 untold; over 320 deg they are told, if less well."""
    template, found, _ = clean()
    sweep = sweeps_of(Plan(count=1), seed=11)[0]
    for most, told in ((280.0, False), (320.0, True)):
        part = sweep.part(np.flatnonzero(np.mod(sweep.reference_deg, 360.0) < most))
        arrays = estimates([part], template.question, rng=np.random.default_rng(0))
        assert np.isfinite(arrays["fitted"]).all() == told
    assert np.all(arrays["fitted_error"][0] > found.batch.arrays["fitted_error"][0])


def test_squares_are_those_of_chi_squared_in_every_direction() -> None:
    """Of order 3 the quadratic term leaves one direction badly known: errors taken together would not tell how far off.

    The share of a hundred devices' squares, of all lines, beyond the point that one in a hundred reaches, and those of
    order 3 alone: within four standard deviations of the binomial.
    """
    _, found, _ = clean()
    squares = found.batch.arrays["candidate_square"]
    lines = [k for k, one in enumerate(found.batch.question.candidates) if one.order is not None]
    third = [k for k in lines if found.batch.question.candidates[k].order == 3.0]
    for places, level in ((lines, 0.01), (third, 0.05)):
        values = squares[:, places].ravel()
        beyond = np.count_nonzero(values > chi2.isf(level, 2))
        assert abs(beyond - level * values.size) < 4.0 * np.sqrt(level * values.size)
    share = found.batch.arrays["candidate"][:, third[0]] / found.batch.arrays["candidate_error"][:, third]
    plain = np.sum(share**2, axis=1)
    # Both directions by one error: the tail is that of one direction, with twice the square.
    assert np.mean(plain > chi2.isf(0.01, 2)) > 0.03
