"""Ringing: a narrow band of noise in the place of the lines that a search makes of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.noise.ringing import ringing as resonance
from diagnosis.discovery.fitting.noise.ringing import within_band
from diagnosis.discovery.search.likelihood_ratio import likelihood, take_out
from diagnosis.discovery.state import State
from twin.noise.description import Noise


def ringing(state: State) -> State:
    """Take noise in a narrow band for a resonance that random knocks keep ringing, and the lines in that band with it.

    A line has all it does at one order or frequency, and a resonance all over its band: where several lines are found
    in one, or one stands out of others that are not, the noise of the band explains them by fewer numbers. Compared by
    Schwarz's criterion (Ann. Statist. 6 (1978) 461): half the log of the rows for each parameter.
    """
    fit = state.fit
    if any(noise.rings for noise in fit.weighting.family.members):
        return state
    found = resonance(fit)
    if found is None:
        return state
    lines = [key for key in state.keys if _lies_in(fit, key, found)]
    without = fit
    for key in lines:
        without = take_out(without, key)
    if lines:
        found = resonance(solve(without)) or found
    rung = _with_member(without, found)
    fewer = sum(free.key in lines for free in fit.free) - _PARAMETERS
    if likelihood(rung) + 0.5 * fewer * np.log(fit.rows) <= likelihood(fit):
        return state
    baseline = None if state.baseline is None else _with_member(state.baseline, found)
    return state.with_(rung, baseline=baseline, keys=tuple(key for key in state.keys if key not in lines))


_PARAMETERS = 3
"""Of a resonance: its frequency, its quality, and the share of the noise that is white beside it."""


def _with_member(fit: Fit, noise: Noise) -> Fit:
    """The fit weighed by this noise, which its family has from here on."""
    family = fit.weighting.family.with_(noise, fit.observations.spectrum(noise))
    weighting = replace(fit.weighting, family=family, member=len(family.members) - 1, members=())
    return solve(evaluate(fit.chain, fit.free, fit.observations, weighting))


def _lies_in(fit: Fit, key: str, noise: Noise) -> bool:
    """Whether most of what a cause does to the angle lies in the band of a resonance."""
    own = [number for number, free in enumerate(fit.free) if free.key == key]
    columns = fit.cosine_jacobian[own, 0]
    return bool(own) and bool(
        np.all(within_band(noise, columns[np.any(columns, axis=1)], fit.observations.lengths) > 0.5)
    )
