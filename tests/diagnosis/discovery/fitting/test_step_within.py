"""A step of the fit within the bounds of its parameters."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.bounded_step import step_within

RNG = np.random.default_rng(4)
ROOT = RNG.standard_normal((5, 5))
SYSTEM = ROOT @ ROOT.T + np.eye(5)
GRADIENT = 3.0 * RNG.standard_normal(5)
FREELY = np.linalg.solve(SYSTEM, GRADIENT)
ANYWHERE = np.full(5, np.inf)
# A solution of five equations with numbers near one, to rounding.
ROUNDING = 1e-12


def test_without_bounds_it_solves_the_equations() -> None:
    assert np.allclose(step_within(SYSTEM, GRADIENT, -ANYWHERE, ANYWHERE), FREELY, rtol=0.0, atol=ROUNDING)


def test_at_a_bound_the_others_make_up_for_what_takes_place() -> None:
    """Held at half of its step, a parameter leaves the others at the least squares beside that half."""
    held = int(np.argmin(FREELY))
    lower = -ANYWHERE
    lower[held] = 0.5 * FREELY[held]
    assert lower[held] < 0.0
    step = step_within(SYSTEM, GRADIENT, lower, ANYWHERE)
    assert step[held] == lower[held]
    slope = GRADIENT - SYSTEM @ step
    assert np.allclose(np.delete(slope, held), 0.0, rtol=0.0, atol=ROUNDING)
    # Beyond the bound it would still gain.
    assert slope[held] < -0.01
    assert not np.allclose(np.delete(step, held), np.delete(FREELY, held), rtol=0.0, atol=0.01)


def test_nothing_moves_where_nothing_may() -> None:
    assert not np.any(step_within(SYSTEM, GRADIENT, np.zeros(5), np.zeros(5)))
