"""Intervals by the profile likelihood, against what can be worked out where the likelihood is no parabola."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.free_parameters import Free, value_of
from diagnosis.discovery.fitting.intervals import intervals_95, quantile_95, standard_deviations
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.profile import CLOSE, reached
from diagnosis.discovery.stages.stepwise import stepwise
from tests.diagnosis.discovery.sweeps import Made, before
from twin.hall.quadratic_nonlinearity import FAR_PERCENT

KEY = "magnet_harmonic"
AMPLITUDE, PHASE = Free(KEY, "amplitude_deg"), Free(KEY, "phase_deg")


def _fitted(amplitude_deg: float, order: float = 5.0, seed: int = 1) -> Fit:
    """A harmonic of the magnet fitted to a turn of 360 readings that hold one."""
    fit = before(stepwise, Made(points=360, seed=seed)).fit
    chain = fit.chain.with_effect(KEY, order=order, amplitude_deg=amplitude_deg, phase_deg=40.0)
    planted = evaluate(chain, fit.free, fit.observations, fit.weighting)
    measured = fit.observations.measured + planted.linear.angle - fit.linear.angle
    observations = replace(fit.observations, measured=measured)
    return solve(evaluate(chain, (*fit.free, AMPLITUDE, PHASE), observations, fit.weighting), iterations=40)


@pytest.mark.parametrize("sigmas", [1.2, 2.5])
def test_a_weak_amplitude_and_its_phase(sigmas: float) -> None:
    """In the plane of sine and cosine part the region is a circle: its distance from the origin and its tangents.

    Over a whole turn both parts are told equally well, and by order 5 as if nothing else were fitted.
    """
    fit = _fitted(sigmas * np.degrees(np.sqrt(_fitted(0.1).variance / 180.0)))
    amplitude, phase = (value_of(fit.chain, one) for one in (AMPLITUDE, PHASE))
    radius = quantile_95(fit) * standard_deviations(fit)[KEY, AMPLITUDE.name]
    ends = intervals_95(fit)
    assert ends[KEY, AMPLITUDE.name] == pytest.approx((amplitude - radius, amplitude + radius), abs=0.03 * radius)
    half = np.degrees(np.arcsin(radius / amplitude))
    # Where an end is found the root deviance is off by CLOSE; near a tangent the angle goes faster.
    assert ends[KEY, PHASE.name] == pytest.approx((phase - half, phase + half), abs=3.0 * CLOSE * half)
    assert half > 1.04 * quantile_95(fit) * standard_deviations(fit)[KEY, PHASE.name]


def test_where_nothing_may_be_there_any_phase_may_be() -> None:
    fit = _fitted(0.2 * np.degrees(np.sqrt(_fitted(0.1).variance / 180.0)))
    low, high = intervals_95(fit)[KEY, PHASE.name]
    radius = quantile_95(fit) * standard_deviations(fit)[KEY, AMPLITUDE.name]
    assert value_of(fit.chain, AMPLITUDE) < radius
    assert (high, low) == pytest.approx((value_of(fit.chain, PHASE) + 180.0, value_of(fit.chain, PHASE) - 180.0))
    assert intervals_95(fit)[KEY, AMPLITUDE.name][0] == 0.0


@pytest.mark.parametrize("seed", [6, 7])
def test_order_3_beside_the_quadratic_term_is_hardly_told(seed: int) -> None:
    """By angles alone the term makes order 1, as offsets do, and order 3: the region is a long bent valley.

    The optimum is by chance so far along it that the parabola there tells a phase that is not the true one; only that
    the term is small is known.
    """
    fit = _fitted(0.05, order=3.0, seed=seed)
    ends = intervals_95(fit)
    phase, half = value_of(fit.chain, PHASE), quantile_95(fit) * standard_deviations(fit)[KEY, PHASE.name]
    assert not phase - half < 40.0 < phase + half
    assert ends[KEY, PHASE.name][0] < 40.0 < ends[KEY, PHASE.name][1]
    assert 0.0 <= ends[KEY, AMPLITUDE.name][0] < 0.0525
    low, high = ends["quadratic_nonlinearity", "q_percent"]
    # The readings and what is known of it before them hold it together, so more closely than the latter alone.
    assert high - low < 2.0 * quantile_95(fit) * FAR_PERCENT


def test_where_the_parabola_holds_it_is_the_interval() -> None:
    fit = before(stepwise, Made(points=360)).fit
    for (key, name), deviation in standard_deviations(fit).items():
        value = value_of(fit.chain, Free(key, name))
        half = quantile_95(fit) * deviation
        assert intervals_95(fit)[key, name] == pytest.approx((value - half, value + half), rel=1e-12)


def test_zeros_of_the_turns_are_at_their_best_beside_the_others() -> None:
    """A zero for each turn is no figure of its own; an order alike in every turn is told as well beside them."""
    turns = 3
    fit = before(stepwise, Made(points=60, turns=turns)).fit
    chain = fit.chain.with_effect(KEY, order=5.0, amplitude_deg=0.006, phase_deg=40.0)
    with_zeros = chain.with_values(
        {"reference_rezero": {"zeros_deg": np.array([0.02, -0.03, 0.01]), "spread_deg": 0.0}}
    )
    zeros = tuple(Free("reference_rezero", "zeros_deg", turn) for turn in range(turns))
    free = (*fit.free, AMPLITUDE, PHASE)
    plain = solve(evaluate(chain, free, fit.observations, fit.weighting), iterations=40)
    fit = solve(evaluate(with_zeros, (*free, *zeros), fit.observations, fit.weighting), iterations=40)
    assert set(intervals_95(fit)) == set(standard_deviations(fit)) == set(intervals_95(plain))
    # of 180 readings three degrees of freedom more are no percent of the width
    assert intervals_95(fit)[KEY, AMPLITUDE.name] == pytest.approx(intervals_95(plain)[KEY, AMPLITUDE.name], rel=0.1)


@pytest.mark.parametrize(
    ("root", "room", "end"),
    [
        (lambda size: size**2, 10.0, np.sqrt(2.0)),
        (lambda size: 3.0 * np.tanh(size), 10.0, np.arctanh(2.0 / 3.0)),
        (lambda size: size, 1.5, 1.5),
    ],
    ids=["steeper", "flatter", "ends at a bound"],
)
def test_how_far_a_root_deviance_reaches(root: object, room: float, end: float) -> None:
    assert reached(root, 0.2, room, 2.0) == pytest.approx(end, rel=2.0 * CLOSE)  # type: ignore[arg-type]
