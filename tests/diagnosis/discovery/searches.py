"""Fits that hold causes which a test has put there, whether the readings know of them or not."""

from __future__ import annotations

from typing import Any

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.search.likelihood_ratio import add
from diagnosis.discovery.search.screening import Candidate
from diagnosis.discovery.state import State
from twin.catalogue import find


def candidate(name: str, fit: Fit, *, log_p: float = 0.0, gain: float = 0.0, **values: Any) -> Candidate:
    """An effect at these parameters, with the score of a screening that was not made."""
    effect = find(name, fit.chain.effects)
    return Candidate(effect, {**effect.null(), **values}, gain, len(fit.linear.terms(effect)), 1.0, log_p)


def with_cause(state: State, name: str, **values: Any) -> State:
    """The state whose joint fit holds one more cause, fitted from these parameters."""
    fit, key = add(state.fit, candidate(name, state.fit, **values))
    return state.with_(fit, keys=(*state.keys, key))
