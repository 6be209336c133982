"""Initial fit: the paper's error model, or a given twin with its zeros set free."""

from __future__ import annotations

from dataclasses import replace

from diagnosis.discovery.fitting.free_parameters import free_of
from diagnosis.discovery.fitting.initial_fit import (
    awake,
    baseline_fit,
    counted_alike,
    fit_of_given,
    senses_of_channels,
)
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.state import State
from twin.catalogue import find


def initial_fit(state: State) -> State:
    """Fit what is not to be explained: all of the baseline, or of a given twin what no device owns.

    Beside the baseline, what the words have told of effects on every reading: the search goes on from there.
    """
    if state.given is None:
        fit = baseline_fit(state.fit)
        if not state.begun:
            return state.with_(fit)
        return state.with_(_with_begun(state, fit), baseline=fit, keys=tuple(state.begun))
    given = counted_alike(state.given, state.fit.observations, senses_of_channels(state.sweep))
    return state.with_(fit_of_given(replace(state.fit, chain=given)), given=given)


def _with_begun(state: State, baseline: Fit) -> Fit:
    """The error model with the effects that the words told, all free, from where these left the readings."""
    observations = baseline.observations
    turns = int(observations.motion.turn.max(initial=0)) + 1
    chain = awake(state.fit.chain).with_values({key: dict(values) for key, values in state.begun.items()})
    free = [
        one
        for key in state.begun
        for one in free_of(find(key, chain.effects), key, turns=turns, channels=observations.observables == 2)
    ]
    return solve(evaluate(chain, (*baseline.free, *free), observations, baseline.weighting))
