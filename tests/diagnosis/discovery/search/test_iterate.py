"""Iterate: the search again until all is still, and the search in which the radius is the work of causes."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate
from diagnosis.discovery.search import iterate
from diagnosis.discovery.search.iterate import searched, trusting
from diagnosis.discovery.search.stepwise import Found
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.stages.test_row_masks import with_radius
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual

RADIUS_NOISE = 3.5e-4
CLEAN = Made(points=120, turns=2, bits=30, channels=True)


@functools.cache
def recorded(made: Made) -> State:
    return before(stepwise, made)


def with_order(state: State, number: int, size: float) -> State:
    """The state whose log radius is white noise of a known size and an order of the turn of so many times that."""
    shaft, fit = state.fit.observations.motion.shaft_rad, state.fit
    white = RADIUS_NOISE * noise(shaft.size, seed=8) / np.radians(0.02)
    wave = RADIUS_NOISE * size * np.sin(number * shaft)
    return with_radius(state, white + wave - fit.residual[1])


@pytest.mark.parametrize(("factor", "explained"), [(0.85, True), (1.15, False)])
def test_more_than_its_noise_is_left_of_the_radius(factor: float, explained: bool) -> None:
    """An order whose power stands to that of the noise on either side of the limit."""
    power = 1.5 * factor - 1.0
    state = with_order(recorded(CLEAN), 6, np.sqrt(2.0 * power))
    assert iterate._radius_explained(state.fit) == explained


@dataclass(frozen=True, kw_only=True)
class Case:
    """A sweep, an order of its radius that no cause makes, and the causes that a trusting search finds, if it ends."""

    made: Made
    order: float = 0.0
    found: tuple[str, ...] | None


CASES = {
    "no channels": Case(made=replace(CLEAN, channels=False), found=None),
    "nothing to explain": Case(made=CLEAN, found=None),
    "a cause explains it": Case(made=replace(CLEAN, causes=(("saturation", 0.1),)), found=("saturation",)),
    "no cause explains it": Case(made=CLEAN, order=6.0, found=None),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_all_that_the_radius_does_has_to_be_the_work_of_causes(case: Case) -> None:
    state = recorded(case.made)
    if case.order:
        state = with_order(state, 6, case.order)
    found = trusting(state.fit, state.searched, state.step, state.touched)
    assert (found and found.keys) == case.found
    if found is not None:
        assert found.fit.weighting.radius_trusted


def test_an_unexplained_radius_is_taken_for_noise_in_the_end() -> None:
    """The stage then searches once more without trusting it, and still finds what the angle shows."""
    made = replace(CLEAN, causes=(("magnet_harmonic", 0.1),))
    after = stepwise(with_order(recorded(made), 7, 6.0))
    assert not after.fit.weighting.radius_trusted
    assert after.keys == ("magnet_harmonic",)


def test_a_radius_that_the_first_round_leaves_unexplained_is_not_searched_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Though the causes have changed, and would in each further round."""
    state = with_order(recorded(CLEAN), 6, 6.0)
    rounds: list[tuple[str, ...]] = []

    def search(fit: Fit, effects: object, keys: tuple[str, ...], *, standings: object, tell: object) -> Found:
        rounds.append(tuple(keys))
        return Found(fit, (f"round {len(rounds)}",), 7)

    monkeypatch.setattr(iterate, "search", search)
    assert trusting(state.fit, state.searched, state.step, state.touched) is None
    assert rounds == [()]


def test_rows_that_stand_alone_only_once_the_causes_are_known_are_masked(monkeypatch: pytest.MonkeyPatch) -> None:
    """The search is made anew without them, until nothing changes any more or the rounds are over."""
    state = recorded(Made(points=120, bits=30))
    fit, rounds = state.fit, []

    def found_with(spike: float) -> Found:
        residual = noise(len(fit.observations))
        residual[40] += spike
        return Found(with_residual(state, residual).fit, ("saturation",), 7)

    def search(fit: object, effects: object, keys: tuple[str, ...], *, standings: object, tell: object) -> Found:
        rounds.append(tuple(keys))
        one = found_with(0.05)
        usable = state.fit.observations.usable & (np.arange(120) != (40 if len(rounds) > 1 else -1))
        fitted = one.fit
        return replace(
            one, fit=evaluate(fitted.chain, fitted.free, fitted.observations.masked(usable), fitted.weighting)
        )

    monkeypatch.setattr(iterate, "search", search)
    found = searched(fit, (), (), step=0.0, also=state.touched)
    assert rounds == [(), ("saturation",)]
    assert tuple(np.flatnonzero(~found.fit.observations.usable)) == (40,)
    assert found.looked_at == 7


def test_a_search_that_never_ends_ends_after_its_rounds(monkeypatch: pytest.MonkeyPatch) -> None:
    state = recorded(Made(points=120, bits=30))
    rounds: list[tuple[str, ...]] = []

    def search(fit: object, effects: object, keys: tuple[str, ...], *, standings: object, tell: object) -> Found:
        rounds.append(tuple(keys))
        return Found(state.fit, (f"round {len(rounds)}",), 7)

    monkeypatch.setattr(iterate, "search", search)
    searched(state.fit, (), (), step=0.0, also=state.touched)
    assert len(rounds) == 3
