"""Listed: what its own figures do not bear out is dropped, and the rest is judged anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.fitting.intervals import may_be_null, quantile_95, standard_deviations
from diagnosis.discovery.fitting.joint_fit import evaluate, solve
from diagnosis.discovery.stages.answer import answer
from diagnosis.discovery.stages.listed import listed
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before

SATURATION, HARMONIC, GRID = "saturation", "magnet_harmonic", "output_quantisation"
MADE = Made(causes=((SATURATION, 0.08),), points=96)


def with_harmonic(amplitude_deg: float) -> State:
    """A state in which a harmonic that the readings know nothing of is held too, fitted, beside the cause there is."""
    state = before(answer, MADE)
    fit = state.fit
    chain = fit.chain.with_effect(HARMONIC, order=6.0, amplitude_deg=amplitude_deg)
    free = (*fit.free, Free(HARMONIC, "amplitude_deg"), Free(HARMONIC, "phase_deg"))
    fit = solve(evaluate(chain, free, fit.observations, fit.weighting))
    found = Finding((HARMONIC,), -30.0, 60.0, -30.0)
    return answer(state.with_(fit, keys=(*state.keys, HARMONIC), findings=(*state.findings, found), held=()))


def test_a_cause_that_may_be_nothing_is_dropped_and_the_rest_fitted_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever it gains."""
    state = with_harmonic(0.01)
    monkeypatch.setattr("diagnosis.discovery.stages.listed._gains_nothing", lambda state, cause: False)
    assert may_be_null(state.fit, HARMONIC)
    assert not may_be_null(state.fit, SATURATION)
    after = listed(state)
    assert [cause.keys for cause in after.causes] == [(SATURATION,)]
    assert HARMONIC not in after.fit.chain.values
    plain = listed(before(listed, MADE)).fit.chain.values[SATURATION]["k_percent"]
    assert after.fit.chain.values[SATURATION]["k_percent"] == pytest.approx(plain, rel=1e-3)
    # What is before the first entry and after the last are the figures of what is left.
    assert len(after.held) == 2


def test_a_phase_that_says_the_same_leaves_no_doubt_of_an_amplitude() -> None:
    """Without an order a phase scales what the amplitude does: alone either may be anything, both are known."""
    state = before(answer, MADE)
    fit, key = state.fit, "unnamed_speed"
    moving = replace(fit.observations.motion, speed_rad_s=np.linspace(1.0, 9.0, len(fit.observations)))
    observations = replace(fit.observations, motion=moving)
    chain = fit.chain.with_effect(key, order=0.0, amplitude_deg=0.2, phase_deg=-60.0, at_rpm=60.0)
    free = (*fit.free, Free(key, "amplitude_deg"), Free(key, "phase_deg"))
    fit = evaluate(chain, free, observations, fit.weighting)
    fit = replace(fit, cosine_residual=before(answer, MADE).fit.cosine_residual)
    assert standard_deviations(fit)[key, "amplitude_deg"] > 1.0
    assert not may_be_null(fit, key)


def test_a_detail_may_be_all_that_there_is_of_a_cause() -> None:
    """A pipeline's first stage is off, and no bit of the converter's: bow and bits are nothing, the cause is not."""
    fit, key = before(answer, MADE).fit, "adc_inl"
    chain = fit.chain.with_effect(key, first_stage_lsb=40.0)
    strengths = tuple(Free(key, name) for name in ("bow_lsb", "bit1_lsb", "bit2_lsb"))
    held = evaluate(chain, (*fit.free, *strengths), fit.observations, fit.weighting)
    assert may_be_null(held, key)
    freed = evaluate(chain, (*held.free, Free(key, "first_stage_lsb")), fit.observations, fit.weighting)
    assert not may_be_null(freed, key)


def test_a_detail_that_acts_through_a_strength_does_not_count_beside_it() -> None:
    """What a drift w (1 + b w) does at 100 K and b = -0.005 / K is half of 100 K, though b by itself takes as much."""
    fit, key = before(answer, MADE).fit, "offset_drift"
    readings = len(fit.observations)
    motion = replace(
        fit.observations.motion,
        temperature_c=np.repeat([25.0, 125.0], [readings // 2, readings - readings // 2]),
        columns=fit.observations.motion.columns | {"temperature_c"},
    )
    chain = fit.chain.with_effect(key, x_percent_per_K=0.02, bend_per_K=-0.005)
    free = (*fit.free, *(Free(key, name) for name in ("x_percent_per_K", "y_percent_per_K", "bend_per_K")))
    fit = evaluate(chain, free, replace(fit.observations, motion=motion), fit.weighting)
    assert not may_be_null(replace(fit, cosine_residual=before(answer, MADE).fit.cosine_residual), key)


def test_a_cause_without_held_out_gain_is_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    state = before(listed, MADE)
    monkeypatch.setattr("diagnosis.discovery.stages.listed.may_be_null", lambda fit, key: False)
    assert listed(state) is state
    worse = tuple(replace(cause, after_deg=cause.before_deg * (1.0 + 1e-6)) for cause in state.causes)
    after = listed(state.with_(causes=worse))
    assert after.causes == ()
    assert after.keys == ()
    assert not np.any([key == SATURATION for key in after.fit.chain.values])


def test_a_grid_with_which_held_out_readings_are_no_nearer_does_not_limit_them() -> None:
    """It stays in the model: the readings lie on it."""
    state = before(listed, Made(bits=12, points=96, turns=2, noise_deg=0.02))
    assert [cause.keys for cause in state.causes] == [(GRID,)]
    assert listed(state) is state
    worse = tuple(replace(cause, after_deg=cause.before_deg * (1.0 + 1e-6)) for cause in state.causes)
    after = listed(state.with_(causes=worse))
    assert after.causes == ()
    assert after.findings == ()
    assert GRID in after.fit.chain.values


def test_an_interval_is_students() -> None:
    """Of 96 readings less seven parameters, 1.3 % wider than a Gaussian one."""
    fit = before(listed, MADE).fit
    freedom = fit.rows - len(fit.free)
    assert quantile_95(fit) == pytest.approx(1.959964 * (1.0 + (1.959964**2 + 1.0) / (4.0 * freedom)), rel=1e-3)
    assert set(standard_deviations(fit)) == {(free.key, free.name) for free in fit.free}
