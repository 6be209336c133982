"""Rivals: which other causes would explain the same readings as well, and what the cause itself gains."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import SMALL_GAIN, Fit, cost_of
from diagnosis.discovery.search import rivals
from diagnosis.discovery.search.likelihood_ratio import add, likelihood
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.search.rivals import judge
from diagnosis.discovery.search.screening import Candidate, screen_one
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.searches import candidate, with_cause
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.adc.adc_inl import STEP_PERCENT
from twin.catalogue import find, unnamed

LIMITS = DiscoverySettings()
SATURATION, HARMONIC, HYSTERESIS, BACKLASH = "saturation", "magnet_harmonic", "hysteresis", "backlash"
MISPLACED, INL = "magnet_misalignment", "adc_inl"


@dataclass(frozen=True, kw_only=True)
class Case:
    """A sweep with one cause, and those that cannot be told from it."""

    made: Made
    rivals: frozenset[str]


CASES = {
    "saturation in a turn": Case(
        made=Made(causes=((SATURATION, 0.05),), points=120), rivals=frozenset({HARMONIC, INL})
    ),
    "saturation with channels": Case(
        made=Made(causes=((SATURATION, 0.05),), points=120, channels=True), rivals=frozenset({INL})
    ),
    # A harmonic's phase is its own, saturation's is locked to the sensor's axes.
    "harmonic of order 5": Case(made=Made(causes=((HARMONIC, 0.05),), points=120, seed=2), rivals=frozenset()),
    # Two displacements together make order 3, of any phase, and no higher one; the channels tell them from it.
    "harmonic of order 3": Case(
        made=Made(causes=((HARMONIC, 0.05),), points=120, seed=13), rivals=frozenset({MISPLACED})
    ),
    "harmonic of order 3 with channels": Case(
        made=Made(causes=((HARMONIC, 0.05),), points=120, seed=13, channels=True), rivals=frozenset()
    ),
    # At one speed a lag in time is a lag in angle, or a play; one turn there and one back might also be a slip between
    # them.
    "latency at one speed": Case(
        made=Made(causes=(("latency", 0.1),), points=72, rpm=(300.0,), back=True, left_out=("turn",)),
        rivals=frozenset({HYSTERESIS, BACKLASH, "index_slip"}),
    ),
    "latency at two speeds": Case(
        made=Made(causes=(("latency", 0.1),), points=72, rpm=(100.0, 300.0), back=True, left_out=("turn",)),
        rivals=frozenset(),
    ),
}


@functools.cache
def handed(made: Made) -> State:
    state = before(held_out_selection, made)
    assert [key.split("#")[0] for key in state.keys] == [name for name, _ in made.causes]
    return state


def judged(state: State) -> rivals.Judged:
    return judge(state.fit, state.keys[0], state.searched, state.keys)


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_which_causes_cannot_be_told_apart(case: Case) -> None:
    state = handed(case.made)
    found = judged(state)
    assert set(found.rivals) == case.rivals
    removal = Removal.of(state.fit, state.keys[0])
    assert (found.gain, found.log_p) == (removal.gain, removal.log_p)
    for name, fit in found.rivals.items():
        # In its place, not beside it; and it fits within three sigma.
        assert state.keys[0] not in fit.chain.values
        assert name in fit.chain.values
        assert 2.0 * (likelihood(state.fit) - likelihood(fit)) < LIMITS.sigma_apart**2


@functools.cache
def nearly(off: float) -> State:
    """A magnet's order 4 whose phase is so far [rad] off that of saturation, in two turns."""
    state = before(held_out_selection, Made(points=120, turns=2, bits=30))
    shape = np.sin(4.0 * state.fit.linear.sensor_angle + off)
    state = with_residual(state, noise(len(state.sweep)) + np.radians(0.03) * shape)
    return with_cause(state, HARMONIC, order=4.0, amplitude_deg=0.03)


@pytest.mark.parametrize(
    ("off", "coarse", "sigma", "same"),
    [(0.24, False, 2.7, True), (0.28, False, 3.3, False), (0.4, True, 5.1, True), (0.5, True, 6.2, False)],
)
def test_as_good_is_within_three_sigma_and_beside_coarse_stairs_within_six(
    off: float, coarse: bool, sigma: float, same: bool
) -> None:
    """By how many sigma saturation fits worse than the harmonic that is there."""
    fit = nearly(off).fit
    fit = replace(fit, weighting=replace(fit.weighting, coarse=coarse))
    removal = Removal.of(fit, HARMONIC)
    rival = screen_one(removal.base, find(SATURATION))
    assert rival is not None
    worse = 2.0 * (likelihood(fit) - likelihood(add(removal.removed, rival)[0]))
    assert np.sqrt(worse) == pytest.approx(sigma, abs=0.1)
    assert (SATURATION in judged(nearly(off).with_(fit)).rivals) == same


@pytest.mark.parametrize(("share", "fitted"), [(0.95, False), (1.05, True)])
def test_only_who_gains_a_share_to_first_order_is_fitted(
    share: float, fitted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    state = handed(CASES["saturation in a turn"].made)
    removal = Removal.of(state.fit, SATURATION)
    assert removal.own is not None
    own = min(removal.gain, removal.own.gain)
    gain = share * (0.3 * own - LIMITS.same_fit(coarse=False))
    assert gain > 0.0
    offered = candidate(HARMONIC, state.fit, gain=gain, order=4.0, amplitude_deg=0.05)
    monkeypatch.setattr(rivals, "screen_one", lambda base, effect: offered)
    found = rivals._in_its_place(state.fit, removal, find(HARMONIC))
    assert (found is not None) == fitted


def test_only_who_may_be_as_good_is_fitted_to_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rivals are fitted roughly first: those by far worse are not asked again, and no answer holds a rough fit."""
    state = handed(CASES["saturation in a turn"].made)
    exact = judged(state).rivals[HARMONIC]
    fitted: list[tuple[str, float]] = []

    def counted(fit: Fit, rival: Candidate, *, iterations: int, least_gain: float = SMALL_GAIN) -> tuple[Fit, str]:
        fitted.append((rival.effect.name, least_gain))
        return add(fit, rival, iterations=iterations, least_gain=least_gain)

    monkeypatch.setattr(rivals, "add", counted)
    monkeypatch.setattr(rivals, "ROUGH_GAIN", np.inf)
    monkeypatch.setattr(rivals, "LEFT_OFF", np.inf)
    assert cost_of(judged(state).rivals[HARMONIC]) == cost_of(exact)
    assert [gain for name, gain in fitted if name == HARMONIC] == [np.inf, SMALL_GAIN]
    fitted.clear()
    monkeypatch.setattr(rivals, "LEFT_OFF", -np.inf)
    assert judged(state).rivals == {}
    assert (HARMONIC, np.inf) in fitted
    assert all(gain == np.inf for _, gain in fitted)


def test_what_has_no_name_is_no_rival() -> None:
    state = handed(CASES["saturation in a turn"].made)
    assert not any(unnamed(name) for name in judged(state).rivals)
    bump = with_cause(state, "unnamed_bump", centre_deg=100.0, width_deg=10.0, height_deg=0.01)
    assert judge(bump.fit, "unnamed_bump", bump.searched, bump.keys).rivals == {}


def test_a_detail_that_no_search_sets_is_a_rival_by_itself() -> None:
    """An S of the converter is the cubic loss k c^3: k percent of it is sqrt(27) / 2 s steps over the range squared."""
    state = handed(CASES["saturation in a turn"].made)
    values = judged(state).rivals[INL].chain.values[INL]
    assert {name for name, value in values.items() if value} == {"s_lsb", "full_scale_percent"}
    k_percent = float(np.sqrt(27.0)) / 2.0 * values["s_lsb"] * STEP_PERCENT / (0.01 * values["full_scale_percent"]) ** 2
    cubic = state.fit.chain.values[SATURATION]["k_percent"]
    # The exponent moves what the cubic alone would be by less than a tenth.
    assert k_percent == pytest.approx(cubic, rel=0.1)


def test_what_an_angle_never_names_acts_on_it_all_the_same() -> None:
    misplaced, provides = find(MISPLACED), frozenset({"one turn"})
    assert misplaced.missing(provides) == ("vx|two air gaps",)
    assert misplaced.acts_in(provides)
    assert not misplaced.acts_in(frozenset())
    # What a drift did at temperatures that nobody recorded is not known.
    assert not find("gain_drift").acts_in(frozenset({"one turn", "vx"}))


def test_what_is_there_already_is_a_rival_with_another_order() -> None:
    """Saturation turns the angle by order 4, which a second harmonic of the magnet does too."""
    state = with_cause(handed(CASES["saturation in a turn"].made), HARMONIC, order=5.0, amplitude_deg=0.01)
    assert HARMONIC in judged(state).rivals
