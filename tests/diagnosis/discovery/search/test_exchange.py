"""Exchange: what no longer pays is removed, what another explains better is exchanged, what stands is kept."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate
from diagnosis.discovery.search import exchange, screening
from diagnosis.discovery.search import removal as removal_module
from diagnosis.discovery.search import stepwise as stepwise_search
from diagnosis.discovery.search.exchange import Search, improve, in_its_place
from diagnosis.discovery.search.likelihood_ratio import Trial, settle
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.search.screening import Base, Candidate
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.searches import candidate, with_cause
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual, with_settings
from twin.angles import Array
from twin.catalogue import CATALOGUE, find, in_order
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion

SATURATION, HARMONIC, LATENCY, PAIR = "saturation", "magnet_harmonic", "latency", "unnamed_pair"
ORDER = "unnamed_order"
BACK = Made(points=180, bits=30, back=True)


@functools.cache
def plain(made: Made) -> State:
    return before(stepwise, made)


def order(number: int, fit: Fit, phase: float = 0.0) -> Array:
    """An order of the sensor's angle, which saturation leaves as the fourth at phase 0."""
    return np.asarray(np.sin(number * fit.linear.sensor_angle + phase))


def reading(state: State, *parts: tuple[float, Array]) -> State:
    """The state whose readings hold these shapes [deg] beside the noise."""
    return with_residual(state, noise(len(state.sweep)) + sum(np.radians(size) * shape for size, shape in parts))


@dataclass(frozen=True, kw_only=True)
class Case:
    """Orders 4 and 5 in the readings [deg], the causes that the fit holds, and those that it holds then.

    ``phase``: how far [rad] order 4 is off saturation's.
    """

    fourth_deg: float
    fifth_deg: float
    phase: float = 0.0
    held: tuple[tuple[str, Mapping[str, float]], ...]
    then: tuple[str, ...]


_AS_SATURATION = (SATURATION, {"k_percent": 0.2})
_AS_FIFTH = (HARMONIC, {"order": 5.0, "amplitude_deg": 0.05})
_AS_FOURTH = (HARMONIC, {"order": 4.0, "amplitude_deg": 0.03})
CASES = {
    "kept: both stand": Case(
        fourth_deg=0.05, fifth_deg=0.05, held=(_AS_SATURATION, _AS_FIFTH), then=(SATURATION, HARMONIC)
    ),
    # log(0.01 / 4 / 15) = -8.7: order 5 is removed at -8.3 and kept at -9.7.
    "removed: just too probable": Case(
        fourth_deg=0.05, fifth_deg=0.006, held=(_AS_SATURATION, _AS_FIFTH), then=(SATURATION,)
    ),
    "kept: just improbable enough": Case(
        fourth_deg=0.05, fifth_deg=0.0065, held=(_AS_SATURATION, _AS_FIFTH), then=(SATURATION, HARMONIC)
    ),
    "exchanged: a harmonic in saturation's place": Case(
        fourth_deg=0.03, fifth_deg=0.05, held=(_AS_FIFTH, _AS_FOURTH), then=(HARMONIC, SATURATION)
    ),
    # A harmonic has six orders and a phase to choose, which costs it five nats less what it fits better by.
    "exchanged: fits a little better": Case(
        fourth_deg=0.03, fifth_deg=0.05, phase=0.115, held=(_AS_FIFTH, _AS_FOURTH), then=(HARMONIC, SATURATION)
    ),
    "kept: fits better by too much": Case(
        fourth_deg=0.03, fifth_deg=0.05, phase=0.13, held=(_AS_FIFTH, _AS_FOURTH), then=(HARMONIC, f"{HARMONIC}#2")
    ),
    # Its proof comes later, on readings that no fit has seen.
    "kept: the only one": Case(fourth_deg=0.0, fifth_deg=0.0, held=(_AS_FIFTH,), then=(HARMONIC,)),
}


def holding(state: State, held: tuple[tuple[str, Mapping[str, float]], ...]) -> State:
    for name, values in held:
        state = with_cause(state, name, **values)
    return state.with_(settle(state.fit)[0])


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_what_becomes_of_the_causes_held(case: Case) -> None:
    state = plain(BACK)
    shapes = ((case.fourth_deg, order(4, state.fit, case.phase)), (case.fifth_deg, order(5, state.fit, 1.0)))
    state = holding(reading(state, *shapes), case.held)
    fit, held, _ = improve(state.fit, state.keys, Search.among(state.searched, state.fit))
    assert tuple(held) == case.then
    assert {one.key for one in fit.free} >= set(held)
    assert (fit is state.fit) == (case.then == state.keys)


def test_a_cause_that_stood_its_ground_is_not_asked_again_in_the_same_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first is exchanged, the second kept in what comes of it: a second round asks for the new one alone."""
    state = plain(BACK)
    state = holding(
        reading(state, (0.03, order(4, state.fit)), (0.05, order(5, state.fit, 1.0))), (_AS_FOURTH, _AS_FIFTH)
    )
    asked: list[str] = []
    of = Removal.of

    def counted(fit: Fit, key: str) -> Removal:
        asked.append(key)
        return of(fit, key)

    monkeypatch.setattr(Removal, "of", counted)
    _, held, _ = improve(state.fit, state.keys, Search.among(state.searched, state.fit))
    assert held == [state.keys[1], SATURATION]
    assert asked == [*state.keys, SATURATION]


def solved(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of what is fitted exactly from here on: a cause's absence, and each of its rivals."""
    asked: list[str] = []
    trial, without = Trial.of, Removal.without.func

    def counted(fit: Fit, rival: Candidate) -> Trial:
        asked.append(rival.effect.name)
        return trial(fit, rival)

    def missed(removal: Removal) -> Fit:
        asked.append(f"no {removal.effect.name}")
        return without(removal)

    known = functools.cached_property(missed)
    known.__set_name__(Removal, "without")
    monkeypatch.setattr(Removal, "without", known)
    monkeypatch.setattr(Trial, "of", counted)
    return asked


def test_what_stood_by_far_stands_without_another_fit_while_no_lead_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    """To first order all is as it was: a little more noise, and so another fit, says nothing new."""
    state = plain(BACK)
    parts = ((0.05, order(4, state.fit)), (0.05, order(5, state.fit, 1.0)))
    before = holding(reading(state, *parts), (_AS_SATURATION, _AS_FIFTH))
    search = Search.among(before.searched, before.fit)
    _, _, standings = improve(before.fit, before.keys, search)
    assert set(standings) == set(before.keys)
    asked = solved(monkeypatch)
    after = holding(reading(state, *parts, (0.0005, order(9, state.fit))), (_AS_SATURATION, _AS_FIFTH))
    fit, held, again = improve(after.fit, after.keys, search, standings)
    assert (fit, tuple(held), asked) == (after.fit, after.keys, [])
    assert all(again[key].seen_in is fit and again[key].log_p == standings[key].log_p for key in held)


def test_what_stood_is_asked_again_once_a_rival_has_drawn_nearer(monkeypatch: pytest.MonkeyPatch) -> None:
    state = plain(BACK)
    fifth = (0.05, order(5, state.fit, 1.0))
    before = holding(reading(state, (0.03, order(4, state.fit, 0.13)), fifth), (_AS_FIFTH, _AS_FOURTH))
    search = Search.among(before.searched, before.fit)
    _, _, standings = improve(before.fit, before.keys, search)
    assert set(standings) == set(before.keys)
    asked = solved(monkeypatch)
    after = holding(reading(state, (0.03, order(4, state.fit)), fifth), (_AS_FIFTH, _AS_FOURTH))
    _, held, _ = improve(after.fit, after.keys, search, standings)
    assert SATURATION in asked
    assert held == [HARMONIC, SATURATION]


def test_what_stood_is_asked_again_once_it_pays_less(monkeypatch: pytest.MonkeyPatch) -> None:
    state = plain(BACK)
    fourth = (0.05, order(4, state.fit))
    before = holding(reading(state, fourth, (0.05, order(5, state.fit, 1.0))), (_AS_SATURATION, _AS_FIFTH))
    search = Search.among(before.searched, before.fit)
    _, _, standings = improve(before.fit, before.keys, search)
    asked = solved(monkeypatch)
    after = holding(reading(state, fourth, (0.006, order(5, state.fit, 1.0))), (_AS_SATURATION, _AS_FIFTH))
    _, held, _ = improve(after.fit, after.keys, search, standings)
    assert f"no {HARMONIC}" in asked
    assert held == [SATURATION]


def test_a_cause_is_looked_at_in_its_own_place_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its removal has done so already: among its rivals it is taken as known."""
    state = plain(BACK)
    state = holding(reading(state, (0.05, order(4, state.fit))), (_AS_SATURATION, _AS_FIFTH))
    looked_at: list[str] = []
    screened = screening.screen_one

    def counted(base: Base, effect: Effect) -> Candidate | None:
        looked_at.append(effect.name)
        return screened(base, effect)

    monkeypatch.setattr(screening, "screen_one", counted)
    monkeypatch.setattr(removal_module, "screen_one", counted)
    examined = exchange._held_or_exchanged(
        state.fit, SATURATION, list(state.keys), Search.among(state.searched, state.fit), None
    )
    assert examined.keys == list(state.keys)
    assert looked_at.count(SATURATION) == 1
    assert len(looked_at) > 10


def test_only_those_are_tried_that_contended_for_its_place() -> None:
    state = plain(BACK)
    state = reading(state, (0.03, order(4, state.fit)), (0.05, order(5, state.fit, 1.0)))
    state = holding(state, (_AS_FIFTH, _AS_FOURTH))
    key = state.keys[-1]
    search = Search.among(state.searched, state.fit).with_contenders({key: [], state.keys[0]: []})
    assert improve(state.fit, state.keys, search)[1] == list(state.keys)


@pytest.mark.parametrize(("beyond", "tried"), [(-0.5, True), (0.5, False)])
def test_first_order_may_undervalue_a_rival_by_so_much(beyond: float, tried: bool) -> None:
    state = plain(BACK)
    state = holding(
        reading(state, (0.03, order(4, state.fit)), (0.05, order(5, state.fit, 1.0))), (_AS_FOURTH, _AS_FIFTH)
    )
    removal = Removal.of(state.fit, state.keys[0])
    assert removal.own is not None
    limit = max(removal.log_p, removal.own.log_p) + 8.0
    offered = [candidate(SATURATION, state.fit, log_p=limit + beyond), candidate(HARMONIC, state.fit, log_p=-500.0)]
    rivals = exchange._rivals(state.fit, removal, offered)
    # Never the cause itself.
    assert [rival.effect.name for rival in rivals] == ([SATURATION] if tried else [])


def test_no_more_rivals_are_tried_than_may_be_but_zeros_of_the_turns_are() -> None:
    """They cost one scatter, not a coefficient each: first order undervalues them."""
    state = holding(reading(plain(BACK)), (_AS_FOURTH,))
    names = ["cardan_coupling", SATURATION, "index_slip", "zero_drift", "backlash", "reference_rezero"]
    offered = [candidate(name, state.fit, log_p=-100.0 + place) for place, name in enumerate(names)]
    removal = Removal.of(state.fit, state.keys[0])
    removal = replace(removal, own=None)
    rivals = [rival.effect.name for rival in exchange._rivals(state.fit, removal, offered, log_p=-50.0)]
    assert rivals == [*names[:3], "reference_rezero"]


@pytest.mark.parametrize(("coarse", "threshold"), [(False, np.log(0.01 / 4.0 / 12.0)), (True, -20.0)])
def test_beside_coarse_stairs_only_what_is_beyond_doubt_counts(coarse: bool, threshold: float) -> None:
    fit = plain(Made(points=180, bits=30, left_out=("time_s", "turn", "direction"))).fit
    fit = replace(fit, weighting=replace(fit.weighting, coarse=coarse))
    search = Search.among([effect for effect in fit.chain.effects if effect.footprint == "mean"], fit)
    visible = [effect for effect in search.effects if not effect.baseline]
    assert len(visible) == 12
    assert Search.among(visible, fit).threshold == pytest.approx(threshold)


# ---- several named causes in the place of a shape without a name ---------------------------------------------------

TWO_SPEEDS = Made(points=90, rpm=(100.0, 400.0), bits=30)


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A shape without a name: shares of its power that saturation, latency and neither of them explain."""

    latency: float
    neither: float = 0.0
    most: int | None = None
    held: tuple[str, ...] = (SATURATION, LATENCY)


PAIRS = {
    "half and half": Pair(latency=0.5),
    # What the second adds to the log likelihood, of both: log(1 + 9 share) / log(10), for nine times the noise's power.
    "a fair share each": Pair(latency=0.065),
    "one does hardly anything": Pair(latency=0.03, held=(PAIR,)),
    "they explain only a part": Pair(latency=0.4, neither=0.2, held=(PAIR,)),
    "one alone may be tried": Pair(latency=0.5, most=1, held=(PAIR,)),
}


def shapes_of(fit: Fit) -> tuple[Array, Array, Array]:
    """Saturation, latency and an order that is neither, each of power one."""
    speed = fit.observations.motion.speed_rad_s
    shapes = order(4, fit), speed - np.mean(speed), order(7, fit)
    return tuple(np.asarray(shape / np.std(shape)) for shape in shapes)  # type: ignore[return-value]


def shape_without_a_name(shape: Array) -> Effect:
    def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        return signal + np.radians(values["height_deg"]) * shape

    height = Param(unit="deg", null=0.0, lower=-90.0, upper=90.0, doc="height")
    return Effect(
        name=PAIR,
        stage="empirical",
        acts_on="angle",
        params={"height_deg": height},
        forward=forward,
        source="a test",
        signature="what two causes leave together",
    )


@pytest.mark.parametrize("case", PAIRS.values(), ids=PAIRS)
def test_named_causes_take_the_place_of_a_shape_that_they_explain(case: Pair) -> None:
    """Of a fixed shape of 0.06 deg in noise of 0.02 deg; two that do as well are worth 400 to 1 more."""
    state = plain(TWO_SPEEDS)
    shares = (1.0 - case.latency - case.neither, case.latency, case.neither)
    shape = sum(np.sqrt(share) * part for share, part in zip(shares, shapes_of(state.fit), strict=True))
    effect = shape_without_a_name(np.asarray(shape))
    fit = reading(state, (0.06, np.asarray(shape))).fit
    chain = replace(fit.chain, effects=in_order((*CATALOGUE, effect)))
    state = state.with_(evaluate(chain, fit.free, fit.observations, fit.weighting))
    if case.most is not None:
        state = with_settings(state, most_in_place=case.most)
    state = holding(state, ((PAIR, {"height_deg": 0.06}),))
    search = Search.among((*plain(TWO_SPEEDS).searched, effect), state.fit)
    assert in_its_place(state.fit, PAIR, list(state.keys), search)[1] == list(case.held)


def test_a_search_that_changes_nothing_asks_no_shape_that_was_handed_in_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether several causes do what it does was asked at the end of the search that found it."""
    asked: list[str] = []

    def recorded(fit: Fit, key: str, keys: list[str], plan: Search) -> tuple[Fit, list[str]]:
        asked.append(key)
        return fit, keys

    monkeypatch.setattr(stepwise_search, "in_its_place", recorded)
    state = plain(BACK)
    state = reading(state, (0.05, order(11, state.fit)))
    found = stepwise_search.search(state.fit, [find(ORDER)])
    assert (found.keys, asked) == ((ORDER,), [ORDER])
    again = stepwise_search.search(found.fit, [find(ORDER)], found.keys, standings=found.standings)
    assert (again.keys, asked) == ((ORDER,), [ORDER])
