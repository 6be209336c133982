"""Stairs of quantisers in a fit: how wide they are, how far noise blurs them, and the fit without them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.linearised_chain import Linear, is_staircase
from twin.angles import Array, wrap
from twin.chain import Chain


def blur_behind(rms: float, step: float) -> float:
    """RMS of the noise ahead of a quantiser, from the RMS of readings about their blurred expectation [rad]."""
    if step <= 0.0 or rms <= 0.0:
        return rms
    ratio = np.geomspace(0.02, 3.0, 60)
    phases = (np.arange(64) + 0.5) / 64
    nodes = np.sort(np.random.default_rng(0).standard_normal(400))
    words = np.round(phases[None, :, None] + ratio[:, None, None] * nodes)
    spread = np.sqrt(np.mean(np.var(words, axis=-1), axis=-1))
    if rms / step > spread[-1]:
        return float(np.sqrt(max(rms**2 - step**2 / 12.0, 0.0)))
    return float(np.interp(rms / step, spread, ratio) * step)


def stair_step(chain: Chain, step: float) -> float:
    """Step [rad] of the coarsest stairs in the chain: the output grid's (``step``), or the mean one of a finite set."""
    steps = [0.0]
    for _, effect, values in chain.active("angle"):
        if effect.footprint == "values":
            steps.append(step if effect.output_grid else effect.stair_rad(values))
    return max(steps)


def reblurred(fit: Fit, step: float) -> Fit:
    """The fit with the blur of its stairs set from what is left."""
    coarse = stair_step(fit.chain, step)
    if coarse <= 0.0:
        return fit
    rms = float(np.sqrt(np.mean(fit.residual[0][fit.evidence.usable] ** 2)))
    blur = blur_behind(rms, coarse)
    if fit.setting.blur > 0.0 and abs(blur / fit.setting.blur - 1.0) < 0.1:
        return fit
    return evaluate(fit.chain, fit.free, fit.evidence, replace(fit.setting, blur=blur))


def without_stairs(fit: Fit, key: str) -> Array:
    """Angle residual (n,) [rad] against the smooth angle ahead of one effect's stairs."""
    smooth = Linear(fit.chain.without(key), fit.evidence.motion, blur=fit.setting.blur, observables=1)
    return wrap(fit.evidence.measured - smooth.angle)


def with_slopes(fit: Fit) -> Fit:
    """The fit at the very optimum of a blurred staircase in the channels, its slopes counted; else as it is.

    The bit's edges move with offset and gain: left out, the bit's weight stops short of its best by more than its
    interval.
    """
    active = list(fit.chain.active("channels"))
    if not any(is_staircase(effect) and float(own.get("blur_percent", 0.0)) > 0.0 for _, effect, own in active):
        return fit
    return solve(evaluate(fit.chain, fit.free, fit.evidence, replace(fit.setting, slopes=True)), iterations=30)
