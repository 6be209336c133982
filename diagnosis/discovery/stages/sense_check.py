"""Sense check: who counts which way is asked once more when the causes are known."""

from __future__ import annotations

from diagnosis.discovery.fitting.joint_fit import evaluate, solve
from diagnosis.discovery.search.likelihood_ratio import likelihood
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State


def sense_check(state: State) -> State:
    """Turn sensor and output round, where that fits better, and search from there.

    Angles alone tell who counts which way by the quadratic term only, and a cause may have stood in for it. What was
    found in the other sense is forgotten.
    """
    fit, baseline = state.fit, state.baseline
    if state.given is not None or baseline is None or fit.observations.observables == 2:
        return state
    other = solve(evaluate(fit.chain.mirrored(), fit.free, fit.observations, fit.weighting))
    if likelihood(other) <= likelihood(fit) + state.settings.swap_log_odds:
        return state
    fresh = solve(evaluate(other.chain.without(*state.keys), baseline.free, fit.observations, fit.weighting))
    return stepwise(state.with_(fresh, keys=()))
