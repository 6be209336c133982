"""Order: each cause stands where it tells, beside those before it."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.discovery.fitting.free_parameters import free_of
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.proof.order import by_turn
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.stages.stepwise import stepwise
from tests.diagnosis.discovery.sweeps import Made, before
from twin.catalogue import find

SEVERAL = Made(causes=(("saturation", 0.3), ("hysteresis", 0.08)), points=90, turns=2, back=True)


def with_causes(made: Made, *names: str) -> Fit:
    """The fit of the baseline to a sweep with these causes, at their optimum."""
    fit = before(stepwise, made).fit
    chain, free = fit.chain, list(fit.free)
    turns = int(fit.observations.motion.turn.max()) + 1
    for name in names:
        effect = find(name)
        begun = (
            {"zeros_deg": np.zeros(turns)} if effect.roles("per turn") else next(iter(effect.shapes(fit.linear.motion)))
        )
        chain = chain.with_effect(name, **begun)
        free += free_of(effect, name, turns=turns, channels=False)
    return solve(evaluate(chain, tuple(free), fit.observations, fit.weighting), iterations=40)


def test_the_stronger_comes_first_wherever_it_stood() -> None:
    fit = with_causes(SEVERAL, "saturation", "hysteresis")
    assert by_turn(fit, [("saturation",), ("hysteresis",)]) == [0, 1]
    assert by_turn(fit, [("hysteresis",), ("saturation",)]) == [1, 0]


def test_of_two_that_do_the_same_the_one_of_fewer_parameters_comes_first() -> None:
    """A further cause that is not there takes its share of the noise: squares alone would have it first."""
    fit = with_causes(Made(causes=(("backlash", 0.08),), points=90, turns=2, back=True), "backlash", "cardan_coupling")
    assert by_turn(fit, [("backlash", "cardan_coupling"), ("backlash",)]) == [1, 0]


def test_what_has_no_name_comes_last_however_strong() -> None:
    state = before(
        held_out_selection, Made(structure=("order_9_to_19", 0.4), causes=(("hysteresis", 0.08),), back=True)
    )
    named = [key for key in state.keys if not key.startswith("unnamed")]
    without = [key for key in state.keys if key.startswith("unnamed")]
    assert named
    assert without
    blocks = [(key,) for key in (*without, *named)]
    ordered = [blocks[place][0] for place in by_turn(state.fit, blocks)]
    assert ordered[: len(named)] == named


def test_what_no_fit_has_a_strength_of_keeps_its_place() -> None:
    fit = with_causes(SEVERAL, "saturation", "hysteresis")
    blocks = [("hysteresis",), ("output_quantisation",), ("saturation",), ("bus_glitch",)]
    assert by_turn(fit, blocks) == [2, 1, 0, 3]


@pytest.mark.parametrize("blocks", [[], [("saturation",)]])
def test_of_one_there_is_nothing_to_order(blocks: list[tuple[str]]) -> None:
    assert by_turn(with_causes(SEVERAL, "saturation"), blocks) == list(range(len(blocks)))
