"""The state between two stages, and the loop that runs until no stage has anything more to say."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import FrozenInstanceError, dataclass

import numpy as np
import pytest

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.observe import observe
from diagnosis.discovery.state import Stage, State, until_still
from tests.diagnosis.discovery.sweeps import Made, start_of
from twin.catalogue import CATALOGUE, find
from twin.chain import Chain

MADE = Made(points=72)


class Recorder:
    """Stages that count up ``looked_at`` as often as they are told to, and who was asked."""

    def __init__(self) -> None:
        self.asked: list[str] = []

    def stage(self, name: str, more: Callable[[State], bool]) -> Stage:
        """A stage that changes the state while ``more`` says so, and else returns it as it is."""

        def ask(state: State) -> State:
            self.asked.append(name)
            return state.with_(looked_at=state.looked_at + 1) if more(state) else state

        return ask


def until(count: int) -> Callable[[State], bool]:
    """More while fewer changes than this have been made in all."""
    return lambda state: state.looked_at < count


@dataclass(frozen=True, kw_only=True)
class Case:
    """For stages a, b, ... how many changes in all each waits for; the rounds allowed; who is asked, in order."""

    until: tuple[int, ...]
    asked: str
    rounds: int = 3


CASES = {
    "nothing to say": Case(until=(0, 0), asked="ab"),
    # b is not asked about the state that it has left itself, a is.
    "the last changes it once": Case(until=(0, 1), asked="aba"),
    "the first changes it once": Case(until=(1, 0), asked="ab"),
    "both, one after the other": Case(until=(1, 2), asked="aba"),
    "two, one after the other": Case(until=(0, 1, 2), asked="abcab"),
    "cut short": Case(until=(99, 99), rounds=2, asked="abab"),
    "one round": Case(until=(99, 99), rounds=1, asked="ab"),
    "no stage": Case(until=(), asked=""),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_the_loop_ends_when_all_is_still_or_the_rounds_are_over(case: Case) -> None:
    recorder = Recorder()
    stages = [recorder.stage(name, until(count)) for name, count in zip("abc", case.until, strict=False)]
    state = start_of(MADE, DiscoverySettings(most_rounds=case.rounds))
    after = until_still(*stages)(state)
    assert "".join(recorder.asked) == case.asked
    assert after.looked_at == min(max(case.until, default=0), case.rounds * len(case.until))
    assert (after is state) == (after.looked_at == 0)


def test_a_loop_may_be_run_again() -> None:
    recorder = Recorder()
    loop = until_still(recorder.stage("a", until(1)))
    assert loop(start_of(MADE)).looked_at == loop(start_of(MADE)).looked_at == 1
    assert len(recorder.asked) == 2


def test_before_the_observations_there_is_no_fit() -> None:
    with pytest.raises(RuntimeError, match="expected `observe` first"):
        _ = start_of(MADE).fit
    assert len(observe(start_of(MADE)).fit.observations) == MADE.points


def test_the_state_is_frozen_and_changed_by_a_copy() -> None:
    state = start_of(MADE)
    with pytest.raises(FrozenInstanceError):
        state.looked_at = 3  # type: ignore[misc]
    changed = state.with_(looked_at=3)
    assert (state.looked_at, changed.looked_at) == (0, 3)
    fit = observe(state).fit
    assert state.with_(fit).fit is fit
    assert observe(state).with_(looked_at=1).fitted is not None


def test_what_is_searched_is_what_the_error_model_lacks() -> None:
    state = start_of(MADE)
    assert {effect.name for effect in state.effects} == {e.name for e in CATALOGUE if not e.baseline}
    assert {effect.name for effect in state.searched} == {
        e.name for e in CATALOGUE if not e.baseline and e.footprint == "mean"
    }


def test_what_has_been_found_is_told_by_place_and_by_name() -> None:
    state = start_of(MADE).with_(
        findings=(Finding.among(2, "stale_frames", -20.0, gain=40.0), Finding.among(9, "hysteresis#2", -9.0, gain=18.0))
    )
    assert {place: state.found(place) for place in ("sequence", "values", "spread")} == {
        "sequence": True,
        "values": False,
        "spread": False,
    }
    assert state.has(find("stale_frames"))
    assert not state.has(find("bus_glitch"))


@pytest.mark.parametrize(("bits", "step"), [(None, 0.0), (12, 2.0 * np.pi / 4096)])
def test_the_step_is_that_of_the_word(bits: int | None, step: float) -> None:
    assert start_of(MADE).with_(bits=bits).step == step


def test_what_the_first_stage_is_handed() -> None:
    sweep = start_of(MADE).sweep
    state = State.of(sweep, Chain())
    assert state.settings == DiscoverySettings()
    assert state.touched.shape == (len(sweep),)
    assert not state.touched.any()
    assert state.given is None
    assert state.rng.bit_generator.state == np.random.default_rng(0).bit_generator.state
