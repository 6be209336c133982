"""Predictive check: sweeps simulated from the extended twin, noise included, are held against the measured one."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise_colour import Colour, colour_of
from diagnosis.discovery.proof.predictive_check import likeness
from diagnosis.discovery.state import State
from twin.catalogue import find, output_grid
from twin.chain import Chain


def predictive_check(state: State) -> State:
    """Complete the extended chain by its noise, and ask whether its sweeps can be told from the measured one."""
    colour, rng = colour_of(state.fit), deepcopy(state.rng)
    fit = replace(state.fit, chain=_with_noise(state, colour))
    return state.with_(fit, likeness=likeness(fit, rng=rng, colour=colour), rng=rng)


def _with_noise(state: State, colour: Colour) -> Chain:
    """The extended chain with the noise that is left and the rare events found, so that it simulates alike."""
    fit = state.fit
    values: dict[str, Mapping[str, Any]] = {"noise": _noise_left(fit, state.step, colour)}
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


def _noise_left(fit: Fit, step: float, colour: Colour) -> dict[str, float]:
    """RMS and colour of the noise ahead of the stairs, less what causes in the spread make of it."""
    use = fit.evidence.usable
    total = left = float(np.mean(fit.residual[0][use] ** 2))
    grid = output_grid(fit.chain.effects)
    if grid is not None and grid.name in fit.chain.values:
        left = fit.setting.blur**2 if fit.setting.blur > 0.0 else left - step**2 / 12.0
    for _, effect, own in fit.chain.active("channels"):
        if effect.spread is not None:
            left -= float(np.mean(effect.spread(fit.linear.sensor_angle, own)))
    # What rounding adds is white: the noise ahead of it is the more correlated.
    share = min(colour.correlated_share * total / max(left, 1e-300), 1.0)
    rms_deg = float(np.degrees(np.sqrt(max(left, 0.0))))
    return {"rms_deg": rms_deg, "correlation": colour.correlation, "correlated_share": share}
