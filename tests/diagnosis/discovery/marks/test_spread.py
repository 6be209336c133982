"""Spread: even noise is called uneven as often as chance allows, whatever its tails."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.marks.row_masks import scaled
from diagnosis.discovery.marks.spread import bursts, row_scale, spread_shapes, squares, white_rows
from diagnosis.discovery.marks.two_variances import TwoVariances
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.variance import variance
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.spreads import Loud, handed
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.adc.reference_jitter import spread as jitter_variance
from twin.catalogue import find
from twin.noise.description import Noise

JITTER = find("reference_jitter")
DRAWS = 200
LEVEL = 0.05
LIMITS = DiscoverySettings()


@functools.cache
def clean() -> State:
    return before(variance, Made(points=120, turns=2, bits=30))


def drawn(tails: str, number: int) -> State:
    """Even noise: Gaussian, or Student's t with four degrees of freedom, whose kurtosis has no bound."""
    rng, n = np.random.default_rng([7, number]), len(clean().sweep)
    unit = rng.standard_normal(n) if tails == "Gaussian" else rng.standard_t(4, n) / np.sqrt(2.0)
    return with_residual(clean(), np.radians(0.02) * unit)


@functools.cache
def log_p_of(tails: str) -> tuple[tuple[float, float], ...]:
    """Log probabilities of a shape and of a stretch for each draw; 0 where none gains."""
    found = []
    for number in range(DRAWS):
        fit = drawn(tails, number).fit
        shape, stretch = spread_shapes(fit, [JITTER]), bursts(fit)
        found.append((shape[0].log_p if shape else 0.0, stretch.log_p if stretch is not None else 0.0))
    return tuple(found)


@pytest.mark.parametrize(("tails", "level"), [("Gaussian", 0.05), ("heavy", 0.05), ("heavy", 0.01)])
def test_even_noise_has_a_shape_no_more_often_than_by_chance(tails: str, level: float) -> None:
    """More draws than these would come in one series of a hundred."""
    log_p = np.array(log_p_of(tails))[:, 0]
    assert np.count_nonzero(log_p < np.log(level)) <= binom.isf(0.01, DRAWS, level)


@pytest.mark.parametrize("tails", ["Gaussian", "heavy"])
def test_even_noise_has_a_loud_stretch_hardly_ever(tails: str) -> None:
    """Improbable enough to be named among ten effects, without a name: by the policy one sweep in a hundred in all."""
    log_p = np.array(log_p_of(tails))[:, 1]
    limit = LIMITS.effect_log_p(10) - LIMITS.unnamed_log_odds
    assert np.count_nonzero(log_p < limit) <= binom.isf(0.01, DRAWS, LIMITS.false_alarm_probability)


def test_a_shape_is_found_as_often_as_its_level_says() -> None:
    """In Gaussian noise: half of the draws gain nothing, and one in twenty is below the level, no fewer."""
    log_p = np.array(log_p_of("Gaussian"))[:, 0]
    assert np.count_nonzero(log_p < np.log(LEVEL)) >= binom.ppf(1e-3, DRAWS, LEVEL)
    assert binom.ppf(1e-3, DRAWS, 0.5) <= np.count_nonzero(log_p == 0.0) <= binom.isf(1e-3, DRAWS, 0.5)


@pytest.mark.parametrize(("factor", "found"), [(0.8, False), (1.25, True)])
def test_a_stretch_is_louder_from_a_ratio_of_the_variances_on(factor: float, found: bool) -> None:
    """However improbable by chance: a third of 360 readings shows even the smaller one."""
    burst = bursts(handed(variance, Loud(stretch=float(np.sqrt(2.25 * factor)), length=120)).fit)
    assert (burst is not None) == found
    assert burst is None or burst.log_p < LIMITS.effect_log_p(10)


def test_what_the_rows_scale_has_taken_out_is_put_back() -> None:
    """The spread is judged on the readings, not on what a scale has made of them."""
    state = handed(variance, Loud(stretch=4.0))
    loud = np.ones(len(state.sweep))
    loud[100:140] = 16.0
    plain, weighed = bursts(state.fit), bursts(scaled(state.fit, loud))
    assert plain is not None
    assert weighed is not None
    assert weighed.values["rms_deg"] == pytest.approx(plain.values["rms_deg"], rel=0.1)
    assert weighed.log_p == pytest.approx(plain.log_p, rel=0.1)


def test_masked_rows_are_no_part_of_it() -> None:
    state = handed(variance, Loud())
    residual = noise(len(state.sweep))
    residual[100:115] *= 30.0
    loud = with_residual(state, residual).fit
    found = bursts(loud)
    assert found is not None
    assert found.log_p < LIMITS.beyond_doubt_log_p
    usable = np.ones(len(residual), dtype=bool)
    usable[100:115] = False
    masked = evaluate(loud.chain, loud.free, loud.observations.masked(usable), loud.weighting)
    left = bursts(masked)
    assert left is None or left.log_p > LIMITS.effect_log_p(1)
    assert np.all(white_rows(masked)[100:115] == 0.0)


def test_rows_weigh_against_the_usual_one() -> None:
    observations = clean().fit.observations
    loud = np.full(len(observations), 4.0)
    loud[:50] = 36.0
    scale = row_scale(observations, loud)
    assert set(np.round(scale, 12)) == {1.0, 3.0}
    assert np.all(row_scale(observations, np.ones(3)) == 1.0)


def test_an_uncertain_instant_scatters_by_the_speed() -> None:
    """Of readings 20 us uncertain, at 60 and 600 rpm: 0.007 and 0.072 deg beside 0.02 of noise."""
    state = before(variance, Made(points=120, turns=2, bits=30, rpm=(60.0, 600.0)))
    speed = state.fit.observations.motion.speed_rad_s
    rng = np.random.default_rng(3)
    residual = np.radians(0.02) * rng.standard_normal(speed.size) + 20e-6 * speed * rng.standard_normal(speed.size)
    (found,) = spread_shapes(with_residual(state, residual).fit, [find("time_jitter")])
    # 240 readings at the higher speed tell a variance to a tenth, its root to a twentieth.
    assert found.values["rms_us"] == pytest.approx(20.0, rel=0.15)
    low, high = found.intervals["rms_us"]
    assert low < 20.0 < high
    assert found.log_p < -30.0
    (slow,) = {float(one) for one in np.round(found.variance[np.abs(speed) < 10.0], 12)}
    (fast,) = {float(one) for one in np.round(found.variance[np.abs(speed) > 10.0], 12)}
    assert fast > 4.0 * slow


def test_few_readings_at_the_highest_speed_tell_it_in_full() -> None:
    """One in fifteen is fifty times as loud: beyond six times the RMS of all, yet no farther out than noise goes."""
    state = before(variance, Made(points=120, turns=2, bits=30, rpm=(30.0,) * 14 + (3000.0,)))
    speed = state.fit.observations.motion.speed_rad_s
    residual = noise(speed.size, 1.0) * (0.02 + np.degrees(50e-6 * np.abs(speed)))
    (found,) = spread_shapes(with_residual(state, residual).fit, [find("time_jitter")])
    assert found.values["rms_us"] == pytest.approx(50.0, rel=0.1)


def test_beside_coloured_noise_an_uncertain_instant_is_as_large_as_it_is() -> None:
    """It is white where the noise is not: what makes the noise white makes it larger, and shares it among readings."""
    state = before(variance, Made(points=90, turns=3, bits=30, rpm=(60.0, 600.0)))
    speed = state.fit.observations.motion.speed_rad_s
    rng, found = np.random.default_rng(5), []
    for _ in range(DRAWS):
        unit, slow = np.radians(0.02) * rng.standard_normal(speed.size), np.zeros(speed.size)
        for row in range(speed.size):
            slow[row] = 0.75 * slow[row - 1] + 0.66 * unit[row]
        residual = slow + 12e-6 * speed * rng.standard_normal(speed.size)
        fit = with_residual(state, residual).fit
        coloured = replace(fit.weighting, member=3)
        (one,) = spread_shapes(evaluate(fit.chain, fit.free, fit.observations, coloured), [find("time_jitter")])
        found.append((one.values["rms_us"], *one.intervals["rms_us"]))
    value, low, high = np.array(found).T
    assert fit.weighting.family.members[3] == Noise(correlation=0.75)
    # The mean of so many draws is known to a tenth of their scatter, and that to a twentieth.
    assert np.mean(value) == pytest.approx(12.0, abs=0.3 * np.std(value))
    assert np.mean(high - low) / (2.0 * 1.96) == pytest.approx(np.std(value), rel=0.12)


def test_what_the_fit_has_taken_of_a_row_is_put_back() -> None:
    """Of 24 quiet rows beside as many loud ones it takes a quarter, of the loud ones next to nothing."""
    state = before(variance, Made(points=24, bits=30, rpm=(60.0, 600.0)))
    loud = np.where(np.arange(48) < 24, 1.0, 25.0)
    rng, left = np.random.default_rng(6), np.zeros((DRAWS, 48))
    for draw in left:
        unlike = with_residual(state, np.radians(0.02) * np.sqrt(loud) * rng.standard_normal(48))
        draw += squares(scaled(unlike.fit, loud)) / (np.radians(0.02) ** 2 * loud)
    assert np.mean(left[:, :24]) == pytest.approx(1.0, abs=0.06)
    assert np.mean(left[:, 24:]) == pytest.approx(1.0, abs=0.06)


def test_intervals_of_few_loud_readings_hold_the_truth() -> None:
    """Of twelve loud readings among two hundred, 95 %: a parabola's would hold it in 88 %, and reach below none."""
    rng, shape = np.random.default_rng(9), np.where(np.arange(200) < 12, 200.0 / 12.0, 0.0)
    held = 0
    for _ in range(DRAWS):
        square = (1.0 + shape) * rng.standard_normal(200) ** 2
        both = TwoVariances(square, np.ones(200), shape).fitted(1.0)
        low, high = both.interval(1.0)
        held += low < 1.0 < high
    assert binom.ppf(0.005, DRAWS, 0.95) <= held <= binom.ppf(0.995, DRAWS, 0.95)


def test_what_several_readings_make_together_is_told_of_a_single_one() -> None:
    """Four readings at each angle, of 0.4 % each."""
    fit = before(variance, Made(points=180, turns=2, bits=30, repeats=4)).fit
    jitter = np.sqrt(jitter_variance(fit.linear.sensor_angle, {"percent_rms": 0.4}) / 4.0) * noise(360, 1.0, seed=4)
    measured = fit.linear.angle + noise(360, 0.01) + jitter / np.radians(1.0)
    unlike = evaluate(fit.chain, fit.free, replace(fit.observations, measured=measured), fit.weighting)
    (found,) = spread_shapes(unlike, [JITTER])
    assert found.values["percent_rms"] == pytest.approx(0.4, rel=0.1)


def test_at_one_speed_there_is_no_shape_of_it() -> None:
    assert spread_shapes(clean().fit, [find("time_jitter")]) == []
