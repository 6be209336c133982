"""Sense check: sensor and output are turned round where that fits better, now that the causes are known."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from diagnosis.discovery.fitting.joint_fit import evaluate, solve
from diagnosis.discovery.search.likelihood_ratio import likelihood
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.sense_check import sense_check
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before

ODDS = DiscoverySettings().swap_log_odds


@dataclass(frozen=True, kw_only=True)
class Case:
    """A sensor that counts as the reference does, asked of a fit that has both the other way round, or right.

    A small quadratic term is all that tells: ``quadratic`` q, which the noise adds to. ``gain``: what the other way
    gains [nats].
    """

    quadratic: float
    gain: float
    seed: int = 1
    wrong: bool = True
    causes: tuple[tuple[str, float], ...] = ()
    back: bool = False


CASES = {
    "just too little": Case(quadratic=1.5e-4, seed=2, gain=1.85),
    "just enough": Case(quadratic=1e-4, seed=1, gain=2.16),
    "enough": Case(quadratic=2e-4, seed=2, gain=3.03),
    "right as it is": Case(quadratic=2e-4, seed=2, wrong=False, gain=-3.03),
    "with a cause": Case(quadratic=3e-4, causes=(("hysteresis", 0.1),), back=True, gain=7.39),
}


def handed(case: Case) -> State:
    sense = -1 if case.wrong else 1
    made = Made(
        quadratic=case.quadratic,
        start_sense=sense,
        start_output=sense,
        causes=case.causes,
        back=case.back,
        points=180,
        seed=case.seed,
    )
    return before(sense_check, made)


def gain_of(state: State) -> float:
    """What the fit gains when both count the other way [nats]."""
    fit = state.fit
    other = solve(evaluate(fit.chain.mirrored(), fit.free, fit.observations, fit.weighting))
    return likelihood(other) - likelihood(fit)


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_what_fits_better_by_the_odds_is_taken(case: Case) -> None:
    state = handed(case)
    assert gain_of(state) == pytest.approx(case.gain, abs=0.05)
    assert state.keys == tuple(name for name, _ in case.causes)
    after = sense_check(state)
    turned = case.gain > ODDS
    assert (after is state) == (not turned)
    assert (after.fit.chain.sensor_sense, after.fit.chain.output_sense) == ((-1, -1) if case.wrong > turned else (1, 1))
    if turned:
        # The search sets out anew from the error model in the other sense, at once: what comes next is judged on it.
        assert after.baseline is not None
        assert state.baseline is not None
        assert after.baseline.chain.sensor_sense == after.fit.chain.sensor_sense
        assert after.baseline.free == state.baseline.free
        assert not {name for name, _ in case.causes} & set(after.baseline.chain.values)
        assert after.keys == state.keys
        assert sense_check(after) is after


def test_a_cause_that_no_mirror_leaves_as_it_is_decides() -> None:
    """A bit that stays at one in y alone is, in the other sense, none: what the search found there is forgotten."""
    right = before(sense_check, Made(quadratic=0.0, causes=(("adc_stuck_bit", 0.3),), back=True, points=180))
    assert right.keys == ("adc_stuck_bit",)
    assert right.baseline is not None
    baseline = right.baseline
    chain = baseline.chain.mirrored().with_effect("hysteresis", lag_deg=0.01)
    wrong = solve(evaluate(chain, baseline.free, right.fit.observations, baseline.weighting))
    state = right.with_(wrong, keys=("hysteresis",))
    # The mirror alone does not tell.
    assert abs(gain_of(state)) < ODDS
    after = sense_check(state)
    assert after.keys == ("adc_stuck_bit",)
    assert after.fit.chain.sensor_sense == right.fit.chain.sensor_sense
    # With nothing found, nothing is in doubt.
    silent = state.with_(
        solve(evaluate(chain.without("hysteresis"), baseline.free, wrong.observations, wrong.weighting))
    )
    assert sense_check(silent.with_(keys=())).keys == ()


CLEAR = CASES["enough"]


def test_the_sense_of_a_given_twin_is_known() -> None:
    state = handed(CLEAR)
    state = state.with_(given=state.start)
    assert sense_check(state) is state


def test_before_a_search_there_is_nothing_to_ask() -> None:
    state = handed(CLEAR).with_(baseline=None)
    assert sense_check(state) is state


def test_channels_tell_the_sense_by_themselves() -> None:
    made = Made(quadratic=3e-4, start_sense=-1, start_output=-1, channels=True, points=180)
    state = before(sense_check, made)
    assert sense_check(state) is state


def test_a_cause_that_stood_in_for_the_quadratic_term_is_left_out_in_the_other_sense() -> None:
    """In the wrong sense the quadratic term is an error of order 3; what else was found there stays found."""
    made = Made(
        quadratic=0.012,
        start_sense=-1,
        start_output=-1,
        causes=(("hysteresis", 0.1),),
        back=True,
        points=180,
    )
    state = before(sense_check, made)
    assert set(state.keys) == {"hysteresis", "magnet_harmonic"}
    # It fits about as well in either: only what the causes cost parts the two.
    assert gain_of(state) < ODDS
    after = sense_check(state)
    assert after.fit.chain.sensor_sense == 1
    assert after.keys == ("hysteresis",)
    assert after.baseline is not None
    assert after.baseline.chain.sensor_sense == 1
    assert sense_check(after) is after
