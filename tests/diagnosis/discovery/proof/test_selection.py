"""Selection: a cause stays that stands out of chance and gains on readings that no fit has seen."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.proof import family_wise as family
from diagnosis.discovery.proof import selection
from diagnosis.discovery.proof.bootstrap import noise_of
from diagnosis.discovery.proof.cross_validation import folds, scattered
from diagnosis.discovery.proof.family_wise import FamilyWise, Tail
from diagnosis.discovery.proof.selection import Proof, prove
from diagnosis.discovery.search.likelihood_ratio import add, take_out
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.search.rivals import Judged
from diagnosis.discovery.search.screening import Base, screen_one
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before
from twin.angles import Array
from twin.catalogue import find

LIMITS = DiscoverySettings()
SATURATION, HARMONIC = "saturation", "magnet_harmonic"
LOG_P = LIMITS.footprint_log_p
EFFECTS = 5


@functools.cache
def handed() -> State:
    state = before(held_out_selection, Made(causes=((SATURATION, 0.08),), points=96))
    assert state.keys == (SATURATION,)
    return state


@dataclass(frozen=True, eq=False)
class _Given:
    """A Jacobian (P, O, n) over the rows that is not the chain's."""

    rows: Array


def proof_of(log_p: float, weighed_deg: Sequence[float], family: FamilyWise | None = None) -> Proof:
    """A proof of one cause with this probability among five effects, and these held-out figures."""
    fit, searched = handed().fit, handed().searched[:EFFECTS]
    cause = Judged(SATURATION, -2.0 * log_p, log_p)
    return Proof(fit, searched, (cause,), folds(fit), (), tuple(weighed_deg), family)


@dataclass(frozen=True, kw_only=True)
class Case:
    """Log probability by chance among five effects, RMS before and after on rows held out, in the order of the causes
    and as the last step, and whether the cause stays."""

    log_p: float
    ordered: tuple[float, float] = (0.03, 0.02)
    last: tuple[float, float] | None = None
    stays: bool


BEYOND = LIMITS.beyond_doubt_log_p
CASES = {
    "just improbable enough": Case(log_p=LOG_P - np.log(EFFECTS) - 0.05, stays=True),
    "just too probable": Case(log_p=LOG_P - np.log(EFFECTS) + 0.05, stays=False),
    "improbable, gains nothing": Case(log_p=-20.0, ordered=(0.02, 0.0201), last=(0.02, 0.0201), stays=False),
    "gains beside the weaker ones": Case(log_p=-20.0, ordered=(0.02, 0.0201), last=(0.02, 0.0199), stays=True),
    "probable, gains much": Case(log_p=-2.0, ordered=(0.1, 0.02), stays=False),
    # What is forgiven is 0.4 %, and of a cause beyond doubt alone.
    "beyond doubt, loses a little": Case(
        log_p=BEYOND - 0.5, ordered=(0.02, 0.0201), last=(0.02, 0.02 * 1.0035), stays=True
    ),
    "beyond doubt, loses more": Case(
        log_p=BEYOND - 0.5, ordered=(0.02, 0.0201), last=(0.02, 0.02 * 1.0045), stays=False
    ),
    "not beyond doubt, loses a little": Case(
        log_p=BEYOND + 0.5, ordered=(0.02, 0.0201), last=(0.02, 0.02 * 1.0005), stays=False
    ),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_which_cause_stays(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Sequence[str]] = []

    def held_out(fit: Fit, keys: Sequence[str], fold: Any, *, at_once: bool, narrow: bool) -> Any:
        asked.append(keys)
        assert not at_once
        assert not narrow
        assert case.last is not None
        return [], list(case.last)

    monkeypatch.setattr(selection, "_held_out", held_out)
    assert selection._proven(proof_of(case.log_p, case.ordered), 0) == case.stays
    # It is held out once more, as the last step, only where its own gains nothing.
    assert len(asked) == int(case.last is not None)


def test_the_probability_is_calibrated_where_it_was() -> None:
    """Scores that fall off at half the rate of a single test: -30 is no more than e^-15 / 2 or so, and of a family."""
    scores = -np.random.default_rng(2).exponential(2.0, 96)
    family = FamilyWise({SATURATION: Tail.of(scores)}, Tail.of(np.log(np.random.default_rng(3).random(96))))
    proof = proof_of(-30.0, (0.03, 0.02), family)
    assert proof.by_chance(proof.causes[0]) == family.log_p(SATURATION, -30.0)
    assert -20.0 < proof.by_chance(proof.causes[0]) < -10.0
    plain = proof_of(-30.0, (0.03, 0.02))
    assert plain.by_chance(plain.causes[0]) == pytest.approx(-30.0 + np.log(EFFECTS))


@pytest.mark.parametrize(("log_p", "simulated"), [(-40.5, False), (-39.5, True)])
def test_only_what_leaves_a_doubt_is_calibrated(log_p: float, simulated: bool) -> None:
    fit = handed().fit
    causes = [Judged(SATURATION, 200.0, -100.0), Judged(SATURATION, 80.0, log_p)]
    effects = [effect for effect in handed().searched if effect.name in (SATURATION, HARMONIC)]
    calibrated = selection._calibrated(fit, effects, causes, np.random.default_rng(1))
    assert (calibrated is not None) == simulated
    if calibrated is not None:
        assert set(calibrated.tails) == {SATURATION, HARMONIC}
        # Calibrated on sweeps without the cause: its own score is far beyond what these reach.
        assert float(calibrated.tails[SATURATION].scores[0]) > -30.0


@pytest.mark.parametrize(("numbers", "sweeps"), [(400, 32), (96 * 60, 60), (10**6, 96)])
def test_as_many_sweeps_are_simulated_as_there_is_room_for(
    numbers: int, sweeps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 96 readings each; never so few that the tail could not be fitted to half of them, nor more than it needs."""
    monkeypatch.setattr(family, "_NUMBERS", numbers)
    fit, effects = handed().fit, [effect for effect in handed().searched if effect.name == SATURATION]
    found = family.family_wise(fit, fit, noise_of(fit), effects, rng=np.random.default_rng(1))
    assert found.tails[SATURATION].scores.size == sweeps


@pytest.mark.parametrize(
    ("share", "member", "log_p", "scatters"),
    [
        (0.21, 0, -9.0, False),
        (0.19, 0, -9.0, True),
        (0.19, 1, -9.0, True),
        (0.5, 0, -9.0, False),
    ],
)
def test_rows_are_held_out_singly_where_a_block_as_a_whole_is_lost(
    share: float, member: int, log_p: float, scatters: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a cause does outside of one fold, on either side of what is too little; in coloured noise as in white."""
    fit = handed().fit
    fold = folds(fit)
    column = np.where(fold == 1, np.sqrt((1.0 - share) / np.sum(fold == 1)), np.sqrt(share / np.sum(fold != 1)))
    jacobian = np.zeros_like(fit.jacobian)
    jacobian[[free.key == SATURATION for free in fit.free]] = column
    fit = replace(fit, columns=_Given(jacobian), weighting=replace(fit.weighting, member=member))
    assert selection.least_seen(fit, [SATURATION], fold) == pytest.approx(share)
    monkeypatch.setattr(selection, "_held_out", lambda *_, **__: ([], [0.02, 0.01]))
    monkeypatch.setattr(selection, "_calibrated", lambda *_: None)
    monkeypatch.setattr(selection, "_judged", lambda *_: Judged(SATURATION, 90.0, log_p))
    proof = prove(fit, handed().searched[:EFFECTS], [SATURATION], rng=np.random.default_rng(0))
    assert np.array_equal(proof.fold, scattered(fit) if scatters else fold)


@pytest.mark.parametrize(("member", "grid", "views"), [(0, True, 1), (3, True, 2), (3, False, 1)])
def test_in_coloured_noise_a_cause_must_stand_without_the_outputs_stairs_too(
    member: int, grid: bool, views: int
) -> None:
    fit = handed().fit
    chain = fit.chain.with_values({"output_quantisation": {"bits": 12.0}}) if grid else fit.chain
    fit = replace(fit, chain=chain, weighting=replace(fit.weighting, member=member))
    seen = selection._views(fit, handed().searched)
    assert len(seen) == views
    assert all("output_quantisation" not in view.chain.values for view in seen[1:])


def test_the_least_favourable_view_judges(monkeypatch: pytest.MonkeyPatch) -> None:
    fit = handed().fit
    judged = {id(fit): Judged(SATURATION, 40.0, -20.0)}
    other = replace(fit)
    judged[id(other)] = Judged(SATURATION, 30.0, -15.0)
    monkeypatch.setattr(selection, "judge", lambda view, *_: judged[id(view)])
    assert selection._judged([fit, other], SATURATION, (), (SATURATION,)) is judged[id(other)]
    assert selection._judged([other, fit], SATURATION, (), (SATURATION,)) is judged[id(other)]


def test_a_class_is_as_unlikely_by_chance_as_its_least_likely_member() -> None:
    """What cannot be told from a cause has been searched for as well."""
    fit, harmonic = handed().fit, find(HARMONIC)
    candidate = screen_one(Base.of(take_out(fit, SATURATION)), harmonic)
    assert candidate is not None
    rival, _ = add(take_out(fit, SATURATION), candidate)
    weak = Judged(SATURATION, 2.0, -1.0, {HARMONIC: rival})
    searched = tuple(effect for effect in handed().searched if effect.name in (SATURATION, HARMONIC))
    proof = Proof(fit, searched, (weak,), folds(fit), (), (0.03, 0.02), None)
    assert proof.by_chance(weak) == pytest.approx(Removal.of(rival, HARMONIC).log_p + np.log(2))
    assert selection._proven(proof, 0)
    # One that was not searched for has not been looked for in chance either.
    proof = replace(proof, effects=(find(SATURATION),))
    assert proof.by_chance(weak) == -1.0
    assert not selection._proven(proof, 0)


@pytest.mark.parametrize(("first", "seen"), [(12, 0.0), (48, 0.75)])
def test_a_step_is_seen_by_the_rows_on_its_shorter_side(first: int, seen: float) -> None:
    """Beside a zero a step that sets in behind 12 of 96 rows, all of one block, is told by that block alone.

    In the middle each of four blocks holds a quarter of either side, dealt out as the folds are.
    """
    fit = handed().fit
    n = len(fit.observations)
    step = (np.arange(n) >= first * n // 96).astype(float)
    jacobian = np.zeros_like(fit.jacobian)
    jacobian[[free.key == SATURATION for free in fit.free]] = step
    jacobian[[free.key == "zero" for free in fit.free]] = 1.0
    fold = np.arange(n) * 4 // n if first == 12 else np.arange(n) % 4
    found = selection.least_seen(replace(fit, columns=_Given(jacobian)), [SATURATION], fold)
    assert found == pytest.approx(seen, abs=0.02)


def test_what_the_others_do_wholly_is_no_evidence_of_either() -> None:
    """Rounding is left of it: no share of that says how the rows are to be held out."""
    fit = handed().fit
    rng = np.random.default_rng(3)
    jacobian = np.array(fit.jacobian)
    own = np.array([free.key == SATURATION for free in fit.free])
    jacobian[own] = np.tensordot(rng.standard_normal(np.count_nonzero(~own)), jacobian[~own], axes=1)
    assert selection.least_seen(replace(fit, columns=_Given(jacobian)), [SATURATION], folds(fit)) == 1.0
