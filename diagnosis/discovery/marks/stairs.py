"""Stairs of quantisers in a fit: how far noise blurs them, and the fit without them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, moved_by, solve
from diagnosis.discovery.fitting.linearised_chain import Linear, is_staircase
from diagnosis.discovery.fitting.noise.rounding import blur_behind, coarsest_stair
from twin.angles import Array, wrap
from twin.confidence import OF_MAD
from twin.effect import Effect

BLUR = "blur_percent"
_ROUNDS = 3
"""Of noise and fit in turn: by the third neither moves any more."""


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


def with_slopes(fit: Fit) -> Fit:
    """The fit at the very optimum of a blurred staircase in the channels, its slopes counted; else as it is.

    The bit's edges move with offset and gain: left out, the bit's weight stops short of its best by more than its
    interval. How far noise blurs the edges is told by the readings between them: the few at an edge, fitted to their
    mean, would rather have it sharp, each reading on its own side.
    """
    keys = {one.key for one in fit.free if one.name == BLUR}
    blurred = [effect for _, effect, _ in fit.chain.active("channels") if effect.name in keys and is_staircase(effect)]
    if not blurred:
        return fit
    free = tuple(one for one in fit.free if one.name != BLUR)
    fit = evaluate(fit.chain, free, fit.observations, replace(fit.weighting, slopes=True))
    for _ in range(_ROUNDS):
        chain = fit.chain
        for effect in blurred:
            found = min(100.0 * _noise_ahead(fit, effect), effect.params[BLUR].upper)
            chain = chain.with_effect(effect.name, **{BLUR: found})
        fit = solve(evaluate(chain, free, fit.observations, fit.weighting), iterations=30)
    return fit


def on_average(fit: Fit) -> Fit:
    """The fit beside a motion that no reference recorded, by what readings behind stairs say on average; else as it is.

    How far the shaft was elsewhere than it is taken to be shows at each edge of a stair, and nothing but a parameter
    can move the edges of the model: least squares would make the parameters hold the shaft's place. On average over
    edges and treads a reading follows the shaft and the parameters alike, and those are where the average, free of
    what the shaft may have done, is at its zero.
    """
    if not fit.by_average:
        return fit
    for _ in range(_ROUNDS):
        residual, columns = fit.whitened()
        scale = np.maximum(np.linalg.norm(columns, axis=1), 1e-300)
        unit = columns / scale[:, None]
        step = np.linalg.pinv(unit @ unit.T, rcond=1e-12, hermitian=True) @ (unit @ residual) / scale
        fit = evaluate(moved_by(fit, step), fit.free, fit.observations, fit.weighting)
    return fit


def _noise_ahead(fit: Fit, effect: Effect) -> float:
    """Standard deviation of the noise ahead of stairs in the channels, in amplitudes of x.

    By the readings that pass on about as much of it as without stairs: neither held on a tread nor thrown by an edge.
    """
    passed = np.sqrt(np.sum(fit.linear.before(effect).sensitivity[0] ** 2, axis=0))
    rows = fit.observations.usable & (passed > 0.5) & (passed < 2.0)
    if not np.any(rows):
        rows, passed = fit.observations.usable, np.ones_like(passed)
    return float(OF_MAD * np.median(np.abs(fit.residual[0][rows]) / passed[rows]))
