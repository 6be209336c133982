"""Grid as a cause: the output's rounding is named where its stairs are seen and make much of what is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.stages.grid_cause import grid_cause
from diagnosis.discovery.stages.quantisation import quantisation
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.angles import TAU

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
    ("share", "points", "sigma", "named"),
    [(1.3, 360, 4.0, False), (1.6, 60, 4.5, False), (1.6, 80, 6.25, True), (1.6, 360, 6.2, True)],
)
def test_stairs_must_be_seen(share: float, points: int, sigma: float, named: bool) -> None:
    """Noise of a fifth of a step blurs them: by how many sigma knowing them gains, near the limit of five."""
    assert (sigma > 5.0) == named
    after = grid_cause(stepped(share, points=points))
    assert [finding.gain**0.5 for finding in after.findings] == ([pytest.approx(sigma, abs=0.05)] if named else [])


def test_no_rounding_where_the_model_has_none() -> None:
    state = before(grid_cause, Made(turns=2))
    assert grid_cause(state) is state
    stairs = stepped(1.6)
    chain = stairs.fit.chain.without(GRID)
    plain = stairs.with_(evaluate(chain, stairs.fit.free, stairs.fit.observations, stairs.fit.weighting))
    assert grid_cause(plain) is plain


def test_no_rounding_beside_another_finite_set() -> None:
    """Whose angles, rounded, lie on the grid anyway."""
    state = stepped(1.6).with_(findings=(Finding(("cordic_truncation",), -100.0, 200.0),))
    assert grid_cause(state) is state
