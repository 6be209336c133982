"""Stairs of quantisers in a fit: how far noise blurs them, and the fit without them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.linearised_chain import Linear, is_staircase
from diagnosis.discovery.fitting.noise.rounding import blur_behind, coarsest_stair
from twin.angles import Array, wrap
from twin.effect import Effect, Parameters


def reblurred(fit: Fit) -> Fit:
    """The fit with the blur of its stairs set from what is left."""
    coarse = coarsest_stair(fit.chain)
    if coarse <= 0.0:
        return fit
    rms = float(np.sqrt(np.mean(fit.residual[0][fit.observations.usable] ** 2)))
    blur = blur_behind(rms, coarse)
    if fit.weighting.blur > 0.0 and abs(blur / fit.weighting.blur - 1.0) < 0.1:
        return fit
    return evaluate(fit.chain, fit.free, fit.observations, replace(fit.weighting, blur=blur))


def without_stairs(fit: Fit, key: str) -> Array:
    """Angle residual (n,) [rad] against the smooth angle ahead of one effect's stairs."""
    smooth = Linear(fit.chain.without(key), fit.observations.motion, blur=fit.weighting.blur, observables=1)
    return wrap(fit.observations.measured - smooth.angle)


def _fitted(effect: Effect, own: Parameters) -> bool:
    """Whether all shapes of an effect that a fit may move are off their null: edges without a blur have no slope."""
    return all(np.any(np.asarray(own[name]) != effect.params[name].null) for name in effect.fitted_shapes)


def with_slopes(fit: Fit) -> Fit:
    """The fit at the very optimum of a blurred staircase in the channels, its slopes counted; else as it is.

    The bit's edges move with offset and gain: left out, the bit's weight stops short of its best by more than its
    interval.
    """
    if not any(is_staircase(effect) and _fitted(effect, own) for _, effect, own in fit.chain.active("channels")):
        return fit
    return solve(evaluate(fit.chain, fit.free, fit.observations, replace(fit.weighting, slopes=True)), iterations=30)
