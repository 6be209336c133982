"""Every stage is a pure function: it leaves the state handed in as it is, and says the same of it a second time."""

from __future__ import annotations

import pytest

from diagnosis.discovery.pipeline import PIPELINE
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.stages.predictive_check import predictive_check
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import Stage
from tests.diagnosis.discovery.content import content
from tests.diagnosis.discovery.sweeps import LOOP, ONCE, Made, before

SWEEPS = {
    "clean": Made(points=72),
    "in doubt": Made(causes=(("saturation", 0.04),), points=144),
    "causes of every kind": Made(
        causes=(("saturation", 0.06), ("stale_frames", 0.05), ("bus_glitch", 0.05)), points=72, turns=2, bits=10
    ),
    "uneven": Made(causes=(("reference_jitter", 0.15), ("cardan_coupling", 0.1)), points=72, turns=2, channels=True),
}


@pytest.mark.parametrize("made", SWEEPS.values(), ids=SWEEPS)
@pytest.mark.parametrize("stage", ONCE, ids=lambda stage: stage.__name__)
def test_a_stage_is_pure(stage: Stage, made: Made) -> None:
    state = before(stage, made)
    handed_in = content(state)
    first = stage(state)
    assert content(state) == handed_in
    assert content(stage(state)) == content(first)


@pytest.mark.parametrize("stage", [held_out_selection, predictive_check], ids=lambda stage: stage.__name__)
def test_a_stage_that_draws_hands_on_a_generator_that_is_further(stage: Stage) -> None:
    """So that two stages never draw the same sweeps."""
    state = before(stage, SWEEPS["in doubt"])
    assert content(stage(state).rng) != content(state.rng)


@pytest.mark.parametrize("stage", [stage for stage in LOOP if stage is not stepwise], ids=lambda stage: stage.__name__)
def test_a_stage_of_the_loop_that_has_nothing_to_say_returns_the_state_itself(stage: Stage) -> None:
    """By which the loop knows that it may end. The search is asked again only of a state that another has changed."""
    state = before(stage, SWEEPS["clean"])
    assert stage(state) is state


def test_these_are_all_stages_of_the_pipeline() -> None:
    outside = tuple(stage for stage in ONCE if stage not in LOOP)
    assert tuple(stage for stage in PIPELINE if stage in ONCE) == outside
    # The rest is the loop.
    assert len(PIPELINE) == len(outside) + 1
