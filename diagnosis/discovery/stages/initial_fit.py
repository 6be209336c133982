"""Initial fit: the paper's error model, or a given twin with its zeros set free."""

from __future__ import annotations

from dataclasses import replace

from diagnosis.discovery.fitting.initial_fit import baseline_fit, counted_alike, fit_of_given, senses_of_channels
from diagnosis.discovery.state import State


def initial_fit(state: State) -> State:
    """Fit what is not to be explained: all of the baseline, or of a given twin what no device owns."""
    if state.given is None:
        return state.with_(baseline_fit(state.fit))
    given = counted_alike(state.given, state.fit.observations, senses_of_channels(state.sweep))
    return state.with_(fit_of_given(replace(state.fit, chain=given)), given=given)
