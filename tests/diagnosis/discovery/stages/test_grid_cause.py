"""Grid as a cause: the output's rounding is named where its stairs are seen and make much of what is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.marks.quantisation import independent_rows
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.grid_cause import grid_cause
from diagnosis.discovery.stages.quantisation import quantisation
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.angles import TAU
from twin.noise.description import Noise

LIMITS = DiscoverySettings()
GRID = "output_quantisation"
BITS = 12
STEP = TAU / 2.0**BITS


def stepped(share: float, *, points: int = 360) -> State:
    """Readings rounded behind noise of which step/sqrt(12) is this share, the grid in the model."""
    state = before(quantisation, Made(points=points, bits=30))
    ahead = noise(points, np.degrees(STEP / np.sqrt(12.0) / share))
    words = np.round((state.fit.linear.angle + ahead) / STEP)
    return quantisation(with_residual(state, words * STEP - state.fit.linear.angle).with_(bits=BITS))


@pytest.mark.parametrize(("share", "named"), [(0.4, False), (1.6, True), (2.0, True)])
def test_rounding_is_named_where_it_limits_the_readings(share: float, named: bool) -> None:
    state = stepped(share)
    after = grid_cause(state)
    assert (after is state) == (not named)
    assert [finding.keys for finding in after.findings] == ([(GRID,)] if named else [])


@pytest.mark.parametrize(("factor", "named"), [(0.9, False), (1.1, True)])
def test_rounding_is_a_cause_from_half_of_the_noise_on(factor: float, named: bool) -> None:
    """The noise ahead of the grid, as the fit holds it, on either side of the catalogue's rule."""
    state = stepped(2.0)
    blur = STEP / np.sqrt(12.0) / (0.5 * factor)
    fit = state.fit
    # The readings keep to their stairs, so that these are seen as before.
    state = state.with_(replace(fit, weighting=replace(fit.weighting, blur=blur)))
    assert (grid_cause(state) is not state) == named


@pytest.mark.parametrize(
    ("share", "points", "log_p", "named"),
    [(1.2, 40, -6.4, False), (1.2, 90, -8.2, True), (1.2, 360, -8.5, True), (1.6, 80, -20.9, True)],
)
def test_stairs_must_be_seen(share: float, points: int, log_p: float, named: bool) -> None:
    """Noise blurs them: knowing them has to gain what chance hardly ever does; the limit for one of two is -6.7."""
    assert (log_p < LIMITS.effect_log_p(2)) == named
    state = stepped(share, points=points)
    assert state.family("values") == 2
    found = grid_cause(state).findings
    assert [finding.log_p for finding in found] == ([pytest.approx(log_p, abs=0.05)] if named else [])
    assert [finding.family_log_p for finding in found] == [finding.log_p + np.log(2.0) for finding in found]


def test_stairs_are_seen_by_fewer_readings_in_correlated_noise() -> None:
    """Of a first-order process with 0.97 from reading to reading 360 tell its variance as well as eleven would."""
    state = stepped(1.2, points=360)
    (white,) = grid_cause(state).findings
    member = state.fit.weighting.family.members.index(Noise(correlation=0.97))
    fit = replace(state.fit, weighting=replace(state.fit.weighting, member=member))
    # (1 - 0.97^2) / (1 + 0.97^2) of 360 readings are 11.0 where the record is long against the correlation.
    assert independent_rows(fit) == pytest.approx(11.0, abs=1.0)
    assert grid_cause(state.with_(fit)).findings == ()
    assert independent_rows(state.fit) == pytest.approx(360.0)
    assert white.gain > LIMITS.sigma_apart**2


def test_a_mean_square_scatters_as_that_of_the_independent_readings() -> None:
    """Of 4000 sweeps the variance is known to sqrt(2 / 4000), and twice the kurtosis' share: five of these."""
    state = stepped(1.2, points=120)
    noise_law = Noise(correlation=0.6)
    member = state.fit.weighting.family.members.index(noise_law)
    fit = replace(state.fit, weighting=replace(state.fit.weighting, member=member))
    coefficients = np.random.default_rng(3).standard_normal((4000, 120)) * np.sqrt(noise_law.spectrum(120))
    squares = np.mean(coefficients**2, axis=1)
    assert np.var(squares) * independent_rows(fit) / 2.0 == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / 4000) * 1.5)


def test_no_rounding_where_the_model_has_none() -> None:
    state = before(grid_cause, Made(turns=2))
    assert grid_cause(state) is state
    stairs = stepped(1.6)
    chain = stairs.fit.chain.without(GRID)
    plain = stairs.with_(evaluate(chain, stairs.fit.free, stairs.fit.observations, stairs.fit.weighting))
    assert grid_cause(plain) is plain


def test_no_rounding_beside_another_finite_set() -> None:
    """Whose angles, rounded, lie on the grid anyway."""
    state = stepped(1.6).with_(findings=(Finding.among(1, "cordic_truncation", -100.0, gain=200.0),))
    assert grid_cause(state) is state
