"""Which noises are plausible: those within e^-4 of the best, all that repeats with the angle set aside.

The restricted likelihoods are worked out once more here, by ordinary least squares of whitened coefficients.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.fft import dct

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise import plausible
from diagnosis.discovery.fitting.noise.plausible import either, locked_shapes, plausible_members
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.angles import Array

REACH, ODDS = 4.0, 3.0
"""Log odds: how far from the best a member may be, and of white noise against each coloured one."""
EDGE = 0.3
"""How far apart the two ways may be."""


@functools.cache
def clean(turns: int, points: int = 120) -> State:
    return before(stepwise, Made(points=points, turns=turns, bits=30))


def correlated(n: int, correlation: float) -> Array:
    """First-order autoregression (n,) [rad] from reading to reading."""
    white = noise(n)
    found = white.copy()
    for row in range(1, n):
        found[row] = correlation * found[row - 1] + np.sqrt(1.0 - correlation**2) * white[row]
    return found


def restricted_log_likelihoods(fit: Fit) -> Array:
    """Of each member (members,), of the residual with the fit's parameters and the locked shapes integrated out."""
    residual = dct(fit.residual[0], type=2, norm="ortho")
    shapes = np.concatenate([fit.jacobian[:, 0], locked_shapes(fit.observations.motion)])
    columns = dct(shapes / np.linalg.norm(shapes, axis=1, keepdims=True), type=2, norm="ortho", axis=1).T
    found = []
    for member, spectrum in enumerate(fit.weighting.family.spectra):
        root = 1.0 / np.sqrt(spectrum)
        white, y = columns * root[:, None], residual * root
        _, size, _ = np.linalg.svd(white, full_matrices=False)
        left = y - white @ np.linalg.lstsq(white, y, rcond=None)[0]
        dof = residual.size - columns.shape[1]
        determinants = np.sum(np.log(spectrum)) + 2.0 * np.sum(np.log(size))
        odds = ODDS if member else 0.0
        found.append(-0.5 * (dof * np.log(left @ left) + determinants) - odds)
    return np.array(found)


@pytest.mark.parametrize("correlation", [0.0, 0.1, 0.15, 0.2, 0.3, 0.5])
def test_members_within_reach_of_the_best_are_plausible(correlation: float) -> None:
    state = clean(4)
    fit = with_residual(state, correlated(len(state.sweep), correlation)).fit
    behind = np.max(score := restricted_log_likelihoods(fit)) - score
    found = np.isin(np.arange(score.size), plausible_members(fit))
    # At the very edge either may be right: some of the shapes that are set aside are nearly the same.
    assert np.all(found[behind < REACH - EDGE])
    assert not np.any(found[behind > REACH + EDGE])


@pytest.mark.parametrize(("turns", "told"), [(3, False), (4, True)])
def test_below_three_and_a_half_turns_any_may_be(turns: int, told: bool) -> None:
    """What repeats with the angle is not told from noise in fewer."""
    state = clean(turns)
    fit = with_residual(state, noise(len(state.sweep))).fit
    everyone = tuple(range(len(fit.weighting.family.members)))
    assert plausible_members(fit) == ((0,) if told else everyone)


def test_of_too_few_readings_any_may_be() -> None:
    """Fewer than four readings for each shape that is set aside."""
    fit = clean(4, 20).fit
    assert len(plausible_members(fit)) == len(fit.weighting.family.members)


def test_structure_that_repeats_with_the_angle_is_no_colour() -> None:
    state = clean(4)
    shaft = state.fit.observations.motion.shaft_rad
    structure = sum(np.radians(0.1) * np.sin(order * shaft + order) for order in (3, 4, 5, 7))
    assert plausible_members(with_residual(state, noise(shaft.size) + structure).fit) == (0,)


def test_a_fit_is_asked_for_its_plausible_members_once(monkeypatch: pytest.MonkeyPatch) -> None:
    fit = with_residual(clean(4), noise(len(clean(4).sweep))).fit
    first = plausible_members(fit)
    monkeypatch.setattr(plausible, "_scores", None)
    assert plausible_members(fit) == first


def test_either_has_the_members_of_any_once() -> None:
    assert either((0, 3), (1, 3), ()) == (0, 1, 3)
