"""Forward step: the cause that the joint fit gains most by, or several that show only together."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.search import forward_step
from diagnosis.discovery.search.exchange import Search
from diagnosis.discovery.search.forward_step import (
    Step,
    best_addition,
    best_together,
    candidates,
    multiples,
    one_more,
    retuned,
)
from diagnosis.discovery.search.likelihood_ratio import likelihood, settle
from diagnosis.discovery.search.screening import Base, Candidate, screen_one
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.searches import candidate, with_cause
from tests.diagnosis.discovery.sweeps import Made, before, noise, truth_of, with_residual, with_settings
from twin.catalogue import find

LIMITS = DiscoverySettings()
SATURATION, HARMONIC = "saturation", "magnet_harmonic"
FOUR_TURNS = Made(points=72, turns=4, bits=30)


def harmonics(made: Made, size_deg: float, orders: tuple[int, ...], **settings: int) -> State:
    """Readings that hold these orders of the shaft, all of one size, beside the noise."""
    state = with_settings(before(stepwise, made), **settings)
    shaft = state.fit.observations.motion.shaft_rad
    shapes = sum(np.sin(order * shaft + order) for order in orders)
    return with_residual(state, noise(len(state.sweep)) + np.radians(size_deg) * np.asarray(shapes))


def both_steps(state: State) -> tuple[Step | None, Step | None]:
    """What is added alone, and what together."""
    fit, base = settle(state.fit)
    search = Search.among(state.searched, fit)
    asked = (fit, base, search.effects, (), search.threshold)
    return best_addition(*asked), best_together(*asked)


@pytest.mark.parametrize("first", ["latency", "backlash"])
def test_of_causes_that_do_the_same_the_sensors_own_leads(first: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """At one speed a lag in time and a play of the shaft are the same: no last digit of a score chooses."""
    state = before(stepwise, Made(points=72, rpm=(300.0,), back=True, causes=(("latency", 0.1),), left_out=("turn",)))
    ranked = candidates

    def in_this_order(*asked: object) -> list[Candidate]:
        return sorted(ranked(*asked), key=lambda one: one.effect.name != first)  # type: ignore[arg-type]

    monkeypatch.setattr(forward_step, "candidates", in_this_order)
    alone, _ = both_steps(state)
    assert alone is not None
    assert list(alone.added) == ["latency"]


@dataclass(frozen=True, kw_only=True)
class Joint:
    """Orders of so many degrees, how many of them may be added together, and how many are."""

    points: int
    size_deg: float
    orders: tuple[int, ...]
    most: int | None = None
    added: int


JOINT = {
    "two": Joint(points=180, size_deg=0.015, orders=(4, 5), added=2),
    "two where one may be": Joint(points=180, size_deg=0.015, orders=(4, 5), most=1, added=0),
    "three": Joint(points=90, size_deg=0.05, orders=(5, 6, 7), added=3),
    "three where two may be": Joint(points=90, size_deg=0.05, orders=(5, 6, 7), most=2, added=0),
    "too weak together": Joint(points=90, size_deg=0.015, orders=(5, 6, 7), added=0),
}


@pytest.mark.parametrize("case", JOINT.values(), ids=JOINT)
def test_causes_that_pass_for_coloured_noise_to_one_another_are_found_together(case: Joint) -> None:
    """Each alone leaves the others, which coloured noise explains as well; the noise is white."""
    made = Made(points=case.points, bits=30)
    settings = {} if case.most is None else {"most_together": case.most}
    alone, together = both_steps(harmonics(made, case.size_deg, case.orders, **settings))
    assert alone is None
    assert (together is None) == (case.added == 0)
    if together is not None:
        assert len(together.added) == case.added
        assert {key.split("#")[0] for key in together.added} == {HARMONIC}
        assert {together.fit.chain.values[key]["order"] for key in together.added} == set(case.orders)
        # Judged with the noise free to be what it is, and by all family members again.
        assert together.fit.weighting.family is before(stepwise, made).fit.weighting.family
        assert together.terms == 2 * case.added


def test_in_white_noise_one_after_the_other_is_enough() -> None:
    """The noise of two turns is told by what does not repeat: white, and nothing is looked for together."""
    state = before(stepwise, Made(points=90, turns=2, bits=30))
    state = with_residual(state, noise(len(state.sweep)))
    fit, base = settle(state.fit)
    assert base.member == 0
    assert best_together(fit, base, state.searched, (), 0.0) is None


# ---- contenders -----------------------------------------------------------------------------------------------------


@functools.cache
def fifth() -> State:
    """Readings with a clear fifth order."""
    return harmonics(FOUR_TURNS, 0.05, (5,))


def offered(true_log_p: float, *, others: int = 1, gain: float = 100.0) -> list[Candidate]:
    """Candidates as a screening might have scored them: saturations in front, the true order behind."""
    fit = fifth().fit
    front = [candidate(SATURATION, fit, log_p=-40.0 + 0.01 * place, gain=100.0) for place in range(others)]
    true = screen_one(settle(fit)[1], find(HARMONIC))
    assert true is not None
    return [*front, replace(true, log_p=true_log_p, gain=gain)]


@dataclass(frozen=True, kw_only=True)
class Contest:
    """By how much first order undervalues the true one, how many stand before it, and whether it is found."""

    front_log_p: float = -40.0
    behind: float
    others: int = 1
    found: bool


CONTESTS = {
    "within reach": Contest(behind=7.5, found=True),
    "out of reach": Contest(behind=8.5, found=False),
    "as many as may be": Contest(behind=1.0, others=4, found=True),
    "one too many": Contest(behind=1.0, others=5, found=False),
}


@pytest.mark.parametrize("case", CONTESTS.values(), ids=CONTESTS)
def test_the_exact_fit_decides_among_those_near_the_best(case: Contest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forward_step, "candidates", lambda *_: offered(-40.0 + case.behind, others=case.others))
    fit, base = settle(fifth().fit)
    step = best_addition(fit, base, fifth().searched, (), LIMITS.effect_log_p(10))
    assert (step is not None) == case.found
    if step is not None:
        assert list(step.added) == [HARMONIC]


@pytest.mark.parametrize(("share", "found"), [(0.9, True), (1.1, False)])
def test_of_strong_causes_the_reach_is_a_share_of_the_score(
    share: float, found: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    front = -400.0
    true = front - share * LIMITS.contender_share * front
    fit, base = settle(fifth().fit)
    ranked = [candidate(SATURATION, fit, log_p=front), offered(true)[-1]]
    monkeypatch.setattr(forward_step, "candidates", lambda *_: ranked)
    assert (best_addition(fit, base, fifth().searched, (), LIMITS.effect_log_p(10)) is not None) == found


@pytest.mark.parametrize(("margin", "found"), [(-0.5, True), (0.5, False)])
def test_first_order_must_be_improbable_too(margin: float, found: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    threshold = LIMITS.effect_log_p(10)
    monkeypatch.setattr(forward_step, "candidates", lambda *_: offered(threshold + margin, others=0))
    fit, base = settle(fifth().fit)
    assert (best_addition(fit, base, fifth().searched, (), threshold) is not None) == found


@pytest.mark.parametrize(("share", "fair"), [(0.9, False), (1.1, True)])
def test_who_explains_a_fair_share_is_remembered(share: float, fair: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """To be tried in its place later: those whose gain to first order is a fair share of the chosen one's."""
    fit, base = settle(fifth().fit)
    true = offered(-40.0, others=0, gain=100.0)
    other = candidate(SATURATION, fit, log_p=-20.0, gain=100.0 * share * 0.15)
    monkeypatch.setattr(forward_step, "candidates", lambda *_: [*true, other])
    step = best_addition(fit, base, fifth().searched, (), LIMITS.effect_log_p(10))
    assert step is not None
    assert {effect.name for effect in step.added[HARMONIC]} == {HARMONIC, *([SATURATION] if fair else [])}


def test_a_cause_that_is_there_is_offered_again_only_where_a_second_makes_sense() -> None:
    _, base = settle(fifth().fit)
    effects = [find(name) for name in (SATURATION, HARMONIC, "unnamed_bump")]
    names = {c.effect.name for c in candidates(base, effects, [SATURATION, HARMONIC, "unnamed_bump"])}
    assert SATURATION in {c.effect.name for c in candidates(base, effects, [])}
    assert SATURATION not in names
    assert HARMONIC in names


@pytest.mark.parametrize(("held", "order"), [((5.0,), 6.0), ((5.0, 6.0), None)])
def test_a_further_instance_has_another_whole_number(held: tuple[float, ...], order: float | None) -> None:
    """Of two clear orders that the fit does not take up; one that is held would be the same again."""
    state = with_residual(fifth(), noise(len(fifth().sweep)))
    shaft = state.fit.observations.motion.shaft_rad
    both = np.radians(0.05) * np.sin(5.0 * shaft) + np.radians(0.02) * np.sin(6.0 * shaft)
    state = with_residual(state, noise(len(state.sweep)) + both)
    chain = state.fit.chain
    for number, one in enumerate(held):
        chain = chain.with_values({f"{HARMONIC}#{number + 2}": {"order": one, "amplitude_deg": 0.0, "phase_deg": 0.0}})
    base = Base.of(replace(state.fit, chain=chain))
    found = one_more(base, find(HARMONIC), [f"{HARMONIC}#{number + 2}" for number in range(len(held))])
    assert found is not None
    assert found.values["order"] not in held
    assert order is None or found.values["order"] == order


def rippled() -> State:
    """Readings with order 50 and its double, which aliases to 20 of 120 points a turn; the fit holds the first."""
    state = before(stepwise, Made(points=120, bits=30))
    shaft = state.fit.observations.motion.shaft_rad
    residual = noise(len(state.sweep)) + np.radians(0.05) * (np.sin(50.0 * shaft) + 0.5 * np.sin(100.0 * shaft + 1.0))
    return with_cause(with_residual(state, residual), "drive_ripple", order=50.0, amplitude_deg=0.05)


def test_a_line_that_is_there_is_looked_for_at_its_multiples() -> None:
    """Also where these alias; near the number of points a turn there is none."""
    state = rippled()
    (found,) = multiples(Base.of(state.fit), state.searched, state.keys)
    assert found.values["order"] == 100.0
    assert found.gain > 20.0


def test_multiples_of_a_line_are_among_the_candidates() -> None:
    state = rippled()
    found = candidates(Base.of(state.fit), [find("drive_ripple")], state.keys)
    assert 100.0 in {one.values["order"] for one in found}


# ---- stuck bits -----------------------------------------------------------------------------------------------------

STUCK = Made(causes=(("adc_stuck_bit", 0.08), (SATURATION, 0.3)), points=180, turns=2)


@pytest.mark.parametrize("off", [0.97, 1.1])
def test_a_stuck_bit_is_found_afresh_once_the_rest_is_known(off: float) -> None:
    """A weight a few per cent off holds on to the wrong edges: the fit alone does not bring it back."""
    true = truth_of(STUCK, "adc_stuck_bit")
    start = {"step_percent": off * true["step_percent"], "level": true["level"], "blur_percent": 0.04}
    state = with_cause(before(stepwise, STUCK), "adc_stuck_bit", **start)
    state = with_cause(state, SATURATION, k_percent=2.0)
    after = retuned(state.fit, state.keys)
    assert likelihood(after) > likelihood(state.fit) + LIMITS.swap_log_odds
    held, found = (float(fit.chain.values["adc_stuck_bit"]["step_percent"]) for fit in (state.fit, after))
    assert abs(held / true["step_percent"] - 1.0) > 0.01
    # Edges lie 0.2 % of the amplitude apart, readings 2 deg: a weight off by more moves most of them.
    assert abs(found / true["step_percent"] - 1.0) < 2e-3
    assert retuned(after, state.keys) is after


def test_other_causes_are_left_as_they_are() -> None:
    state = with_cause(fifth(), HARMONIC, order=5.0, amplitude_deg=0.05)
    assert retuned(state.fit, state.keys) is state.fit


def test_a_level_that_explains_a_share_is_fitted_beside_those_that_come_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """So is the best of the others where the first joins several parts; no level of a small share."""
    fit = before(stepwise, FOUR_TURNS).fit
    named = ["multipole", SATURATION, "unnamed_bump", HARMONIC, "clipping"]
    asked = forward_step._asked_as_well
    ranked = [candidate(name, fit, log_p=-90.0 + place, gain=100.0 - place) for place, name in enumerate(named)]
    assert [c.effect.name for c in asked(ranked, ranked[:1], 0.15)] == [SATURATION, "clipping"]
    assert [c.effect.name for c in asked(ranked[1:], ranked[1:2], 0.15)] == ["clipping"]
    assert asked(ranked[1:], ranked[1:], 0.15) == []
    weak = [*ranked[1:4], candidate("clipping", fit, log_p=-9.0, gain=14.0)]
    assert asked(weak, weak[:1], 0.15) == []
