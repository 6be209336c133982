"""The turns' zeros: they scatter as much as is most likely, wherever a fit sets out from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.free_parameters import free_of
from diagnosis.discovery.fitting.joint_fit import Fit, _scatter, evaluate, solve
from diagnosis.discovery.stages.stepwise import stepwise
from tests.diagnosis.discovery.sweeps import Made, before
from twin.angles import Array
from twin.catalogue import find

TURNS, POINTS = 8, 12
MADE = Made(causes=(("reference_rezero", 0.05),), points=POINTS, turns=TURNS)


def fitted(**start: dict[str, float]) -> Fit:
    """The fit with a zero for each turn, set out from these values of the baseline."""
    fit = before(stepwise, MADE).fit
    effect = find("reference_rezero")
    chain = fit.chain.with_effect(effect.name, zeros_deg=np.zeros(TURNS), spread_deg=0.0).with_values(start)
    free = (*fit.free, *free_of(effect, effect.name, turns=TURNS, channels=False))
    return solve(evaluate(chain, free, fit.observations, fit.weighting), iterations=60)


def zeros_deg(fit: Fit) -> Array:
    return np.asarray(fit.chain.values["reference_rezero"]["zeros_deg"])


def test_they_are_the_same_from_afar() -> None:
    """From where the residual is a hundred times the noise, and any zero next to nothing beside it."""
    near, far = fitted(), fitted(offset={"x_percent": 8.0, "y_percent": -6.0}, gain_mismatch={"ratio": 1.05})
    assert np.std(zeros_deg(near)) > 0.02
    np.testing.assert_allclose(zeros_deg(far), zeros_deg(near), atol=1e-3)


def test_the_scatter_is_the_most_likely() -> None:
    """Each zero has the mean of its turn, which scatters as the zeros do and the noise's share."""
    fit = fitted()
    turn, noise = fit.observations.motion.turn, float(np.std(fit.residual[0]))
    means = np.array([np.mean((fit.residual[0])[turn == k]) for k in range(TURNS)]) + np.radians(zeros_deg(fit))
    own = float(np.var(means, ddof=1)) - noise**2 / POINTS
    held = np.array([fit.strengths[place] for place, one in enumerate(fit.free) if one.turn is not None])
    # The strength is the noise's RMS over the scatter, in degrees; what the baseline takes of the means is left out.
    np.testing.assert_allclose(noise / held, np.degrees(np.sqrt(own)), rtol=0.1)


def test_zeros_that_no_reading_tells_stay_as_they_are() -> None:
    """As of a recording without rows in use."""
    fit = fitted()
    away = replace(fit.observations, usable=np.zeros_like(fit.observations.usable))
    blind = replace(fit, columns=replace(fit.columns, observations=away))
    assert not blind.cosine_jacobian.any()
    turns = [place for place, one in enumerate(fit.free) if one.turn is not None]
    assert _scatter(blind, turns, 1.0) == pytest.approx(np.std(zeros_deg(fit), ddof=1))
