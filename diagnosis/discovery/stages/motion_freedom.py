"""How free the shaft's motion is against the noise, where no reference was recorded and causes have made noise less."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, root_weights, solve
from diagnosis.discovery.fitting.noise_family import noise_family
from diagnosis.discovery.state import State

_CHANGED = 0.05
"""Change of the noise that is worth another fit: the weights of the motion then differ by a tenth."""


def motion_freedom(state: State) -> State:
    """Hold the motion as free as it was found to be, against the noise that the causes leave.

    How far the shaft may have moved of itself was found in radians, beside all that the readings did that no angle
    explains. Once a rounding, a wave in time or another cause is known that made most of that, the readings tell of
    less noise, and the motion and its torques are as free as before: against it freer.
    """
    fit = state.fit
    estimated = fit.observations.motion.estimated
    if estimated is None:
        return state
    noise_rad = _noise_rad(fit)
    if not 0.0 < noise_rad < (1.0 - _CHANGED) * estimated.noise_rad:
        return state
    baseline = None if state.baseline is None else _at_noise(state.baseline, noise_rad)
    return state.with_(_at_noise(fit, noise_rad), baseline=baseline)


def _noise_rad(fit: Fit) -> float:
    """RMS [rad] of the noise of the angle, by its whitened residual."""
    whitened = fit.cosine_residual[0] * root_weights(fit.weighting, fit.observations.observables)[0]
    return float(np.sqrt(whitened @ whitened / max(fit.rows - len(fit.free), 1)))


def _at_noise(fit: Fit, noise_rad: float) -> Fit:
    """The fit with the motion as free as it is, against readings of this noise."""
    observations = fit.observations
    assert observations.motion.estimated is not None
    motion = replace(observations.motion, estimated=observations.motion.estimated.at_noise(noise_rad))
    observations = replace(observations, motion=motion)
    family = fit.weighting.family
    family = noise_family(
        observations.lengths, family.colour_log_odds, motion=observations.motion_spectrum, members=family.members
    )
    weighting = replace(fit.weighting, family=family)
    return solve(evaluate(fit.chain, fit.free, observations, weighting))
