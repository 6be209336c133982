"""The search of a log without a reference counts as its fit does: without what the shaft may have done of itself."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from diagnosis.discovery.fitting.coefficients import without_motion
from diagnosis.discovery.fitting.initial_fit import baseline_fit, unfitted
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.observations import collect
from diagnosis.discovery.search.likelihood_ratio import add, likelihood
from diagnosis.discovery.search.screening import Base, matched, screen_one
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.spin.of_log import sweeps_of
from diagnosis.spin.torques import torque_columns
from tests.diagnosis.spin.test_explain import even
from tests.diagnosis.spin.test_smoother import TIME, coasting, read
from twin.adc.xy_skew import XY_SKEW
from twin.angles import wrap
from twin.catalogue import CATALOGUE, find
from twin.chain import Chain
from twin.empirical.orders import UNNAMED_SPEED, UNNAMED_SPEED_ZERO
from twin.motion import Motion
from twin.recordings import Setup
from twin.spin import Spin

HARMONIC = find("magnet_harmonic", CATALOGUE)


@cache
def fit_of_a_coast() -> Fit:
    """The error model on a coast with a torque and an error of order 3, 0.004 rad, that the model has not."""
    (sweep,) = sweeps_of([Spin.from_columns({"time_s": TIME, "measured_deg": np.degrees(read(coasting()))})])
    return baseline_fit(unfitted(collect(sweep), Chain(), DiscoverySettings()))


def test_a_candidate_gains_to_first_order_what_it_gains_in_the_fit() -> None:
    """Which is less than along a direction that a torque of the same order is not free to take."""
    fit = fit_of_a_coast()
    candidate = screen_one(Base.of(fit), HARMONIC, shapes=[{"order": 3.0}])
    assert candidate is not None
    trial, key = add(fit, candidate)
    assert candidate.gain == pytest.approx(2.0 * (likelihood(trial) - likelihood(fit)), rel=0.02)
    assert np.radians(trial.chain.values[key]["amplitude_deg"]) == pytest.approx(0.004, rel=0.2)
    # The quadratic term, which makes an order 3 as well, is held by the noise, which is known better with the harmonic.
    assert candidate.values["amplitude_deg"] == pytest.approx(trial.chain.values[key]["amplitude_deg"], rel=0.15)


def test_what_a_torque_may_be_scatters_about_none_and_not_about_what_was_found() -> None:
    """Along a torque a residual is what was found of it, counted by how much torques scatter: readings count once."""
    fit = fit_of_a_coast()
    observations, estimated = fit.observations, fit.observations.motion.estimated
    assert observations.loose is not None
    assert estimated is not None
    off = wrap(observations.measured - fit.linear.angle)
    assert fit.residual[0] == pytest.approx(observations.loose.whitened(off + observations.torques), abs=1e-12)
    found = without_motion(observations, np.asarray(observations.torques)) / estimated.noise_rad
    scatter = [
        (torque.cos_rad_s2**2 + torque.sin_rad_s2**2) / torque.scatter_rad_s2**2
        for torque in estimated.torques
        if torque.scatter_rad_s2
    ]
    # Of a torque that may grow with the speed as well, less is needed of each.
    assert 0.5 * sum(scatter) < found @ found < sum(scatter)


def test_lines_are_matched_to_what_torques_do_not_make() -> None:
    """What is left has nothing along a torque; whitened once alone it would have, and its order would be looked at."""
    fit = fit_of_a_coast()
    loose, columns = fit.observations.loose, torque_columns(fit.observations.motion)
    assert loose is not None
    torque = columns[np.argmax(np.sum(columns**2, axis=1))]
    for white in matched(Base.of(fit)):
        once = fit.residual[0]
        assert abs(white @ torque) / np.linalg.norm(white) < 0.2 * abs(once @ torque) / np.linalg.norm(once)


def test_residuals_are_without_what_the_shaft_may_have_done() -> None:
    """A drift slower than a turn is nothing, a wave that no torque makes stays, rows never held out stay so."""
    fit = fit_of_a_coast()
    observations = fit.observations
    drift = np.linspace(-1.0, 1.0, len(observations)) ** 3
    wave = np.cos(7.5 * observations.motion.shaft_rad)
    assert np.std(without_motion(observations, drift)) < 0.15 * np.std(drift)
    assert np.std(without_motion(observations, wave) - wave) < 0.1
    drift[:10] = np.nan
    assert np.isnan(without_motion(observations, drift)[:10]).all()


@pytest.mark.parametrize("speeds", [(9.0, 25.0), (9.0, 15.0, 25.0)])
def test_what_follows_the_speed_takes_a_third_one_beside_torques(speeds: tuple[float, ...]) -> None:
    """At two, an order that grows with the speed is a constant one beside a torque, whose response falls with it."""
    spins = [Spin.from_columns(even(one, order=3, seed=seed)) for seed, one in enumerate(speeds)]
    motion = Motion.joined([one.motion() for one in sweeps_of(spins)], [Setup()] * len(speeds))
    for effect in (UNNAMED_SPEED, XY_SKEW):
        assert effect.visible_in(motion.provides) is (len(speeds) == 3)
        assert effect.visible_in(motion.provides | {"a reference"})
    assert XY_SKEW.visible_in(motion.provides | {"vx"})
    assert not UNNAMED_SPEED_ZERO.visible_in(motion.provides)
