"""Changes: which of a given twin's own parameters have moved; all others go back to what they were."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.f_test import log_probability
from diagnosis.discovery.fitting.free_parameters import Free, value_of
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.own_parameters import set_back
from diagnosis.discovery.proof.changes import TWIN_VARIANCE, Change, Differences, another_device
from diagnosis.discovery.search.likelihood_ratio import add, drop
from diagnosis.discovery.search.rivals import judge
from diagnosis.discovery.search.screening import Base, Candidate, screen
from diagnosis.discovery.state import State
from twin.catalogue import base_name, find, unnamed
from twin.each_recording import everywhere
from twin.effect import Effect
from twin.moved_placement import PLACEMENT, movable

_TRIED = 4
"""Moved numbers of a placement that are fitted exactly: a displacement from both sides, and what it is mistaken for."""


def changes(state: State) -> State:
    """Hold what has not moved at the twin's values, and name what has, with all that would do as well.

    A new cause takes the place of several parameters that have moved where it does the same with fewer.
    """
    if state.given is None or not state.own:
        return state
    twin, full = state.given, state.fit
    offered = _named(state)
    told = Differences.of(full, twin, state.own, effects=len(offered))
    found = told.changes(full, twin)
    counts_otherwise = _counts_otherwise(state)
    other = another_device(full, told.free, found) or counts_otherwise
    fit = _with(state, found)
    together = _leaves_more_than_chance(state, fit, told.threshold)
    # Moved by much, a magnet moves all that is counted in its field, as another device would.
    if (found or state.keys or together) and not counts_otherwise:
        placement = _placement_instead(state, found, fit, told)
        if placement is not None and not _leaves_more_than_chance(state, placement.fit, told.threshold):
            return placement
    if together:
        # Each within its chance, but not all together: what the earlier mounting hardly told stays free.
        return state.with_(changed=found, other_device=other, fitted_anew=True, held=())
    if found and not other:
        # Of another device everything is another value: no single cause would do the same.
        cause = _instead(state, found, fit, told.price)
        if cause is not None:
            return cause
        found = _with_rivals(state, found, fit, told.same)
    return state.with_(fit, changed=found, other_device=other, held=())


def _leaves_more_than_chance(state: State, fit: Fit, threshold: float) -> bool:
    """Whether what is not named makes the fit worse by more than chance once it is held at the twin's values."""
    held = len(state.fit.free) - len(fit.free)
    if not held:
        return False
    gain = _squares(state, fit) - _squares(state, state.fit)
    dof = state.fit.freedom
    return float(log_probability(np.array(dof * np.log1p(max(gain, 0.0) / dof)), held, dof)) < threshold


def _counts_otherwise(state: State) -> bool:
    """Whether the readings count the other way than the twin that was handed in."""
    start, given = state.start, state.given
    return given is not None and start.sensor_sense * start.output_sense != given.sensor_sense * given.output_sense


def _named(state: State) -> tuple[Effect, ...]:
    """Effects with a name that may stand in the place of a change."""
    provides = state.fit.observations.motion.provides
    present = {*state.keys, *(base_name(free.key) for free in state.own)}
    return tuple(
        effect
        for effect in state.searched
        if effect.visible_in(provides) and not unnamed(effect.name) and effect.name not in present
    )


def _with(state: State, moved: Iterable[Change]) -> Fit:
    """The fit in which these alone of the twin's parameters may be others than the twin's."""
    assert state.given is not None
    free = {change.free for change in moved}
    return set_back(state.fit, [one for one in state.own if one not in free], state.given)


def _squares(state: State, fit: Fit) -> float:
    """Chi-squared of a fit by the noise of the one in which everything is free, as differences are counted."""
    left, _ = fit.whitened()
    return float(left @ left) / state.fit.variance / TWIN_VARIANCE


def _contenders(state: State, without: Fit, gain: float) -> list[Candidate]:
    """Candidates that may do as well as changes that gain so much, from the fit without these."""
    base = Base.of(without)
    share = state.settings.rival_share
    return [candidate for candidate in screen(base, _named(state)) if candidate.gain > share * min(gain, base.dof)]


def _instead(state: State, found: Sequence[Change], fit: Fit, price: float) -> State | None:
    """The state with a new cause in the place of several changes, where it does the same with fewer parameters."""
    if len(found) < 2:
        return None
    without = _with(state, ())
    with_changes = _squares(state, fit)
    gain = _squares(state, without) - with_changes
    for candidate in _contenders(state, without, gain):
        trial, key = add(without, candidate)
        worth = _squares(state, trial) + price * candidate.terms
        if worth < with_changes + price * len(found) - 2.0 * state.settings.swap_log_odds:
            judged = judge(trial, key, _named(state), [*state.keys, key])
            family = judged.log_p + float(np.log(max(len(_named(state)), 1)))
            finding = Finding((key,), judged.log_p, judged.gain, family, judged.rivals)
            return state.with_(trial, keys=(*state.keys, key), findings=(finding, *state.findings), held=())
    return None


def _placement_instead(state: State, found: Sequence[Change], fit: Fit, told: Differences) -> State | None:
    """The state with one number of the magnet's placement moved, where that does the same as changes and causes do.

    It takes the place of all changes, and of one cause or none: where it does that with fewer parameters.
    """
    assert state.given is not None
    given = movable(state.given)
    if given is state.given:
        return None
    terms = {key: sum(one.key == key for one in state.fit.free) for key in state.keys}
    worth = _squares(state, fit) + told.price * (len(found) + sum(terms.values())) - 2.0 * state.settings.swap_log_odds
    tried = []
    for dropped in (None, *state.keys):
        without = _with(state, ()) if dropped is None else drop(_with(state, ()), dropped)
        kept = sum(count for key, count in terms.items() if key != dropped)
        for trial in _moved_placements(without):
            tried.append((_squares(state, trial) + told.price * (1 + kept), dropped, trial))
    best, dropped, trial = min(tried, key=lambda one: one[0])
    if best >= worth:
        return None
    gain = _squares(state, drop(trial, PLACEMENT)) - _squares(state, trial)
    alike = [other.free[-1].name for value, key, other in tried if key == dropped and value < best + told.same]
    moved = trial.free[-1]
    log_p = told.log_p(gain)
    change = Change(
        free=moved,
        owner=find(PLACEMENT, trial.chain.effects).owner(moved.name),
        was=value_of(given, moved),
        gain=gain,
        log_p=log_p,
        family_log_p=log_p + float(np.log(told.family + len(find(PLACEMENT, trial.chain.effects).params))),
        rivals=tuple(f"{PLACEMENT}.{name}" for name in dict.fromkeys(alike) if name != moved.name),
    )
    keys = tuple(key for key in state.keys if key != dropped)
    findings = tuple(one for one in state.findings if dropped not in one.keys)
    return state.with_(trial, given=given, keys=keys, findings=findings, changed=(change,), held=())


def _moved_placements(fit: Fit) -> list[Fit]:
    """A fit with one number of the magnet's placement moved: each of those that promise most, to either side."""
    chain, begun = movable(fit.chain), []
    effect = find(PLACEMENT, chain.effects)
    for name, param in effect.params.items():
        free = (*fit.free, Free(PLACEMENT, name))
        for side in (-1.0, 1.0):
            # On the axis what a displacement does is of second order: from there no fit sets out.
            moved = chain.with_values({PLACEMENT: {**effect.null(), name: param.null + side * param.typical}})
            begun.append(evaluate(moved, free, fit.observations, fit.weighting))
    return [solve(one) for one in sorted(begun, key=lambda one: one.squares_to_first_order)[:_TRIED]]


def _with_rivals(state: State, found: Sequence[Change], fit: Fit, same: float) -> tuple[Change, ...]:
    """The changes with the new causes that would do as well: in the place of each, or of all together."""
    with_changes = _squares(state, fit)
    groups: list[tuple[Change, ...]] = [(change,) for change in found]
    if len(found) > 1:
        groups.append(tuple(found))
    rivals: dict[str, list[str]] = {}
    for group in groups:
        without = _with(state, [change for change in found if change not in group])
        gain = _squares(state, without) - with_changes
        for candidate in _contenders(state, without, gain):
            trial, _ = add(without, candidate)
            if _squares(state, trial) < with_changes + same:
                for change in group:
                    rivals.setdefault(change.name, []).append(everywhere(candidate.effect.name))
    return tuple(change.with_rivals(rivals.get(change.name, ())) for change in found)
