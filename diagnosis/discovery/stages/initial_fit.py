"""Initial fit: the paper's error model, or a given twin with its zeros set free."""

from __future__ import annotations

from diagnosis.discovery.fitting.initial_fit import baseline_fit, fit_of_given
from diagnosis.discovery.state import State


def initial_fit(state: State) -> State:
    """Fit what is not to be explained: all of the baseline, or of a given twin what no device owns."""
    fit = baseline_fit(state.fit) if state.given is None else fit_of_given(state.fit)
    return state.with_(fit)
