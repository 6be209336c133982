"""Sense check: who counts which way is asked once more when the causes are known."""

from __future__ import annotations

from collections.abc import Sequence

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.search.exchange import Search
from diagnosis.discovery.search.likelihood_ratio import Trial, drop, handicap, likelihood, settle
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.search.screening import Base, screen_one
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from twin.effect import Effect


def sense_check(state: State) -> State:
    """Turn sensor and output round, where that describes the readings better, and search on from there.

    Angles alone tell who counts which way by the quadratic term only, and a cause may have stood in for it: in the
    other sense it has nothing to do, and is left out there. Each sense is judged by its likelihood, less what each of
    its causes had to gain to be added. Where the other one keeps all causes, they are forgotten and looked for anew. So
    they are where one cause that no mirror leaves as it is, such as a stuck bit, is better there by itself. Those that
    the words have told stay in either sense.
    """
    fit, baseline = state.fit, state.baseline
    told = fit.observations.observables == 2 or state.sweep.senses is not None
    if state.given is not None or baseline is None or told:
        return state
    other = solve(evaluate(fit.chain.mirrored(), fit.free, fit.observations, fit.weighting))
    here = likelihood(fit) + state.settings.swap_log_odds
    turned = _mirrored(state, baseline, other, here)
    if turned is None and state.keys and not state.begun:
        fresh = solve(evaluate(other.chain.without(*state.keys), baseline.free, fit.observations, fit.weighting))
        if _one_cause_beats(here, fresh, state.searched):
            turned = state.with_(fresh, keys=())
    return state if turned is None else stepwise(turned)


def _mirrored(state: State, baseline: Fit, other: Fit, here: float) -> State | None:
    """The state in the other sense, with what it keeps of the causes; None where that is no better than ``here``."""
    fit, plan = state.fit, Search.among(state.searched, state.fit)
    # Before any is left out: no more can be won than what all of them cost.
    if likelihood(other) - plan.threshold * len(state.keys) <= here:
        return None
    pruned, keys = _pruned(other, state.keys, plan)
    spared = len(state.keys) - len(keys)
    if likelihood(pruned) - plan.threshold * spared <= here:
        return None
    fresh = solve(evaluate(pruned.chain.without(*keys), baseline.free, fit.observations, fit.weighting))
    if not spared and not state.begun:
        return state.with_(fresh, keys=())
    return state.with_(pruned, keys=keys, baseline=fresh)


def _one_cause_beats(least: float, fit: Fit, effects: Sequence[Effect]) -> bool:
    """Whether one of the effects that no mirror leaves as they are takes the fit beyond this likelihood."""
    base, short = Base.of(fit), least - likelihood(fit)
    tried = (screen_one(base, effect) for effect in effects if not (effect.mirrors or effect.baseline))
    for one in tried:
        if one is None:
            continue
        needed = short + handicap(one.effect, fit)
        # Its gain to first order is twice a likelihood; an exact fit is worth its time where it may gain enough.
        near = one.gain > fit.settings.rival_share * 2.0 * needed
        if near and likelihood(Trial.of(fit, one).fit) > likelihood(fit) + needed:
            return True
    return False


def _pruned(fit: Fit, keys: tuple[str, ...], plan: Search) -> tuple[Fit, tuple[str, ...]]:
    """The fit without the causes that have nothing to do in it, the idlest first."""
    kept = list(keys)
    while kept:
        judged = {key: Removal.of(fit, key) for key in kept}
        score = {key: one.log_p + handicap(one.effect, fit) for key, one in judged.items()}
        idlest = max(kept, key=lambda key: score[key])
        if score[idlest] <= plan.threshold:
            break
        fit, _ = settle(drop(fit, idlest))
        kept.remove(idlest)
    return fit, tuple(kept)
