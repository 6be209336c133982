"""Sense check: who counts which way is asked once more when the causes are known."""

from __future__ import annotations

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.search.exchange import Search
from diagnosis.discovery.search.likelihood_ratio import drop, handicap, likelihood, settle
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State


def sense_check(state: State) -> State:
    """Turn sensor and output round, where that describes the readings better, and search on from there.

    Angles alone tell who counts which way by the quadratic term only, and a cause may have stood in for it: in the
    other sense it has nothing to do, and is left out there. Each sense is judged by its likelihood, less what each of
    its causes had to gain to be added. Where the other one keeps all causes, they are forgotten and looked for anew.
    """
    fit, baseline = state.fit, state.baseline
    if state.given is not None or baseline is None or fit.observations.observables == 2:
        return state
    plan = Search.among(state.searched, fit)
    other = solve(evaluate(fit.chain.mirrored(), fit.free, fit.observations, fit.weighting))
    here = likelihood(fit) + state.settings.swap_log_odds
    # Before any is left out: no more can be won than what all of them cost.
    if likelihood(other) - plan.threshold * len(state.keys) <= here:
        return state
    pruned, keys = _pruned(other, state.keys, plan)
    spared = len(state.keys) - len(keys)
    if likelihood(pruned) - plan.threshold * spared <= here:
        return state
    fresh = solve(evaluate(pruned.chain.without(*keys), baseline.free, fit.observations, fit.weighting))
    if not spared:
        return stepwise(state.with_(fresh, keys=()))
    return stepwise(state.with_(pruned, keys=keys, baseline=fresh))


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
