"""What causes do to a fit beside an estimated motion: less noise, and stairs whose edges tell of the shaft as well."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.initial_fit import baseline_fit, unfitted
from diagnosis.discovery.fitting.intervals import intervals_95, parabola_95
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.observations import collect
from diagnosis.discovery.search.likelihood_ratio import add
from diagnosis.discovery.search.screening import Base, screen_one
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.final_fit import final_fit
from diagnosis.discovery.stages.motion_freedom import motion_freedom
from diagnosis.discovery.state import State
from diagnosis.spin.of_log import sweeps_of
from tests.diagnosis.spin.test_smoother import NOISE, TIME, coasting, read
from twin.catalogue import CATALOGUE, find
from twin.chain import Chain
from twin.spin import Spin
from twin.sweep import Sweep

WAVE_DEG, WAVE_HZ = 0.2, 50.0
BITS = 10


def sweep_of(readings: np.ndarray) -> Sweep:
    (sweep,) = sweeps_of([Spin.from_columns({"time_s": TIME, "measured_deg": np.degrees(readings)})])
    return sweep


@functools.cache
def beside_a_wave(*, known: bool) -> State:
    """A coast with a wave in time that is ten times the noise; ``known``: it is among what is fitted."""
    wave = np.radians(WAVE_DEG) * np.cos(2.0 * np.pi * WAVE_HZ * TIME)
    sweep = sweep_of(read(coasting()) + wave)
    fit = baseline_fit(unfitted(collect(sweep), Chain(), DiscoverySettings()))
    causes = [("magnet_harmonic", {"order": 3.0})]
    if known:
        causes.append(("unnamed_tone", {"frequency_Hz": WAVE_HZ}))
    for name, shape in causes:
        candidate = screen_one(Base.of(fit), find(name, CATALOGUE), shapes=[shape])
        assert candidate is not None
        fit, _ = add(fit, candidate)
    return State.of(sweep, Chain()).with_(fit)


def test_a_motion_is_as_free_as_before_against_the_noise_that_causes_leave() -> None:
    """The wave is noise to the motion's fit, and none once it is known."""
    state = beside_a_wave(known=True)
    before = state.fit.observations.motion.estimated
    after = motion_freedom(state).fit.observations.motion.estimated
    assert before is not None
    assert after is not None
    assert before.noise_rad == pytest.approx(np.radians(WAVE_DEG) / np.sqrt(2.0), rel=0.05)
    assert after.noise_rad == pytest.approx(NOISE, rel=0.05)
    slow = before.spectrum < 1e6
    assert after.spectrum[slow] * after.noise_rad**2 == pytest.approx(before.spectrum[slow] * before.noise_rad**2)


def test_a_motion_stays_as_it_is_where_the_noise_is_what_it_was() -> None:
    state = beside_a_wave(known=False)
    assert motion_freedom(state) is state


@functools.cache
def behind_stairs() -> Fit:
    """The error model on a coast that is read in words of ten bits, after the last fit."""
    step = 2.0 * np.pi / 2**BITS
    angle = coasting()
    state = State.of(sweep_of(step * np.floor(read(angle) / step)), Chain())
    fit = baseline_fit(unfitted(collect(state.sweep), Chain(), DiscoverySettings()))
    stairs = fit.chain.with_effect("output_quantisation", bits=BITS)
    fit = solve(evaluate(stairs, fit.free, fit.observations, replace(fit.weighting, blur=NOISE)))
    return final_fit(state.with_(fit, baseline=fit)).fit


def test_stairs_behind_an_estimated_motion_tell_on_average() -> None:
    """No parameter could move by a twentieth of its standard deviation to bring the average to its zero."""
    fit = behind_stairs()
    residual, columns = fit.whitened()
    along = columns @ residual / np.maximum(np.linalg.norm(columns, axis=1), 1e-300)
    assert np.abs(along).max() < 0.05 * np.sqrt(fit.variance)


def test_intervals_behind_such_stairs_are_those_of_the_average() -> None:
    """The likelihood of sharp stairs knows the factors by their edges alone, ten times as well."""
    fit = behind_stairs()
    assert dict(intervals_95(fit)) == parabola_95(fit)
