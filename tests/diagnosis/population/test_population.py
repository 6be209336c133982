"""Factors, odd devices, changes and corrections of a batch."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.population.apart import FACTORS_AND_RESIDUAL, distances, standing_apart
from diagnosis.population.batch import Batch
from diagnosis.population.changes import log_p_of_change
from diagnosis.population.population import population_of
from tests.diagnosis.population.batches import clean, looked
from tests.hidden.fleets.generator import SPREAD_PERCENT, Plan
from tests.hidden.fleets.study import sweeps_of
from tests.hidden.streams import stream
from twin.errors import UserError


def test_factors_hold_what_was_put_in() -> None:
    """Mean and spread of the offsets of sixty devices: 99.9 % of intervals of 95 %, widened by two thirds."""
    _, _, population = clean()
    wanted = dict(zip(("offset x", "offset y"), stream(11, "batch").uniform(-1.0, 1.0, 2), strict=True))
    for one in population.factors[:2]:
        half = 0.5 * (one.found.high - one.found.low)
        assert abs(one.found.mean - wanted[one.factor.label]) < 5.0 / 3.0 * half
        assert 0.6 * one.found.spread_low < SPREAD_PERCENT < 1.6 * one.found.spread_high
    assert [one.factor.label for one in population.factors] == list(FACTORS_AND_RESIDUAL[:-1])


def test_no_device_stands_apart_and_nothing_changes_in_a_plain_batch() -> None:
    _, _, population = clean()
    assert population.apart == ()
    assert population.changes == ()


def test_odd_devices_are_found_with_what_they_are_odd_in() -> None:
    plan = Plan(count=60, odd={7: ("hysteresis", 0.08), 21: ("offset", 12.0)})
    _, found = looked(plan, seed=16)
    population = found.population
    assert {one.device: one.figures[0] for one in population.apart} == {7: "hysteresis", 21: "offset x"}
    # Neither becomes a cause of the batch, nor widens the spread of the others.
    assert population.causes == ()
    assert population.factors[0].found.spread < 1.5 * SPREAD_PERCENT


def test_since_when_an_offset_has_moved() -> None:
    _, found = looked(Plan(count=60, moved=(35, 3.0 * SPREAD_PERCENT)), seed=17)
    (change,) = found.population.changes
    assert change.figure == "offset x"
    assert change.change.shape == "step"
    assert change.change.low <= 35 <= change.change.high
    assert change.change.high - change.change.low < 10
    assert change.change.size == pytest.approx(3.0 * SPREAD_PERCENT, rel=0.4)


def test_chance_of_a_change_is_no_more_than_it_says() -> None:
    """Of 1000 series in any order at most a tenth is below 0.1, heavy tails or not: 100 + 3 sigma of 9.5."""
    rng = np.random.default_rng(18)
    values = rng.standard_cauchy((1000, 80))
    assert np.count_nonzero([log_p_of_change(row) < np.log(0.1) for row in values]) < 128


def test_a_step_and_a_drift_are_changes() -> None:
    rng = np.random.default_rng(19)
    noise = rng.standard_normal(80)
    assert log_p_of_change(noise + 3.0 * (np.arange(80) >= 30)) < np.log(1e-6)
    assert log_p_of_change(noise + 0.06 * np.arange(80)) < np.log(1e-6)
    assert log_p_of_change(np.ones(80)) == 0.0


def test_corrections_leave_what_the_readings_show() -> None:
    """Common and own corrections of the factors, computed here from the readings by the generator's own formula."""
    template, found, population = clean()
    left = {one.name: one for one in population.corrections}
    assert list(left) == ["none", "common factors", "own factors"]
    own = found.batch.arrays["fitted"]
    mean = (own.sum(axis=0) - own) / (len(own) - 1)
    sweeps = sweeps_of(Plan(count=60), seed=11)
    ideal = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (60, 1))
    for name, values in (("common factors", mean), ("own factors", own), ("none", ideal)):
        squares = []
        for sweep, point in zip(sweeps, values, strict=True):
            x, y, gain, beta, quad, _ = point
            zero = own[len(squares), 5]
            angle = np.radians(sweep.reference_deg + zero)
            c, s = np.cos(angle), np.sin(angle + np.radians(beta))
            read = np.degrees(
                np.arctan2(0.01 * y + gain * (s + 0.01 * quad * s * s), 0.01 * x + c + 0.01 * quad * c * c)
            )
            off = (sweep.measured_deg - read + 180.0) % 360.0 - 180.0
            squares.append(np.mean((off - off.mean()) ** 2))
        # To first order in factors of a per cent.
        assert left[name].rms_deg == pytest.approx(np.sqrt(np.mean(squares)), rel=0.03)
    assert template.question.output_sense == 1


def test_too_few_devices_are_refused() -> None:
    _, found, _ = clean()
    with pytest.raises(UserError, match="1 of 1 devices can be used; expected at least 2"):
        population_of(found.batch.part(np.arange(60) == 3), {})


def test_a_device_that_is_known_badly_does_not_stand_apart() -> None:
    """Ten times the errors of the others, and as far off as these let it be: three of its own."""
    _, found, _ = clean()
    batch = found.batch
    arrays = {name: values.copy() for name, values in batch.arrays.items()}
    off = 15.0 * SPREAD_PERCENT
    arrays["fitted"][5, 0] += off
    assert 5 in {one.device for one in standing_apart(batch, distances(Batch(batch.names, batch.question, arrays)))}
    arrays["fitted_error"][5, 0] = off / 3.0
    assert 5 not in {one.device for one in standing_apart(batch, distances(Batch(batch.names, batch.question, arrays)))}
