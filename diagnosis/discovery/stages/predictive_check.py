"""Predictive check: the extended twin against sweeps simulated from it, noise included, and repeated readings."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any

from diagnosis.discovery.proof.bootstrap import noise_of, twin_parameters
from diagnosis.discovery.proof.lack_of_fit import lack_of_fit
from diagnosis.discovery.proof.predictive_check import likeness
from diagnosis.discovery.state import State
from twin.catalogue import find
from twin.chain import Chain
from twin.hall.noise import NOISE
from twin.noise.description import Noise


def predictive_check(state: State) -> State:
    """Complete the extended chain by its noise, and ask whether its sweeps can be told from the measured one.

    Where readings were repeated in place, their scatter is asked as well.
    """
    noise, rng = noise_of(state.fit), deepcopy(state.rng)
    fit = replace(state.fit, chain=_with_noise(state, noise))
    lack = lack_of_fit(fit, step_rad=state.step)
    return state.with_(fit, likeness=likeness(fit, rng=rng, noise=noise), lack=lack, rng=rng)


def _with_noise(state: State, noise: Noise) -> Chain:
    """The extended chain with the noise that is left and the rare events found, so that it simulates alike."""
    fit = state.fit
    values: dict[str, Mapping[str, Any]] = {NOISE.name: twin_parameters(fit, noise)}
    for key, own in fit.chain.values.items():
        drawn = find(key, fit.chain.effects).spread_of_turns(own)
        if drawn:
            values[key] = {**own, **drawn}
    for cause in state.causes:
        marks = find(cause.keys[0], fit.chain.effects).marks
        if marks is not None:
            told = marks.told(len(cause.rows), len(state.sweep))
            values[cause.keys[0]] = {name: value for name, (value, _) in told.items()}
    return fit.chain.with_values(values)
