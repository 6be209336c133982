"""Rounding in the noise: which part of it lies ahead of the stairs, and where the stairs leave nothing else to see."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from twin.angles import Array
from twin.chain import Chain
from twin.noise.description import Noise


def ahead_of_stairs(fit: Fit, noise: Noise) -> Noise:
    """The noise of a fit's readings before they were rounded: rounding adds white noise of its own."""
    use = fit.observations.usable
    total = float(np.sqrt(np.mean(fit.residual[0][use] ** 2)))
    ahead = blur_behind(total, coarsest_stair(fit.chain))
    if not 0.0 < ahead < total:
        return noise
    coloured = min((1.0 - noise.white_share) * (total / ahead) ** 2, 1.0)
    return replace(noise, rms_rad=noise.rms_rad * ahead / total, white_share=1.0 - coloured)


def coarsest_stair(chain: Chain) -> float:
    """Step [rad] of the coarsest stairs behind the channels; 0 where there are none."""
    active = chain.active("angle")
    return max((effect.stair_rad(own) for _, effect, own in active if effect.footprint == "values"), default=0.0)


def blur_behind(rms: float, step: float) -> float:
    """RMS of the noise ahead of a quantiser, from the RMS of readings about their blurred expectation [rad]."""
    if step <= 0.0 or rms <= 0.0:
        return rms
    ratio, spread = _spread_of_words()
    if rms / step > spread[-1]:
        return float(np.sqrt(max(rms**2 - step**2 / 12.0, 0.0)))
    return float(np.interp(rms / step, spread, ratio) * step)


@lru_cache(maxsize=1)
def _spread_of_words() -> tuple[Array, Array]:
    """RMS (60,) of noise ahead of a quantiser, and that of its words about their mean (60,), both in steps."""
    ratio = np.geomspace(0.02, 3.0, 60)
    phases = (np.arange(64) + 0.5) / 64
    nodes = np.sort(np.random.default_rng(0).standard_normal(400))
    words = np.round(phases[None, :, None] + ratio[:, None, None] * nodes)
    return ratio, np.asarray(np.sqrt(np.mean(np.var(words, axis=-1), axis=-1)))


def stairs_rule(fit: Fit) -> bool:
    """Whether stairs make most of the spread: how much a reading scatters then depends on its place between two steps.

    The variance is no evidence of anything else there.
    """
    stairs = fit.linear.stair_variance
    if stairs is not None and float(np.mean(stairs)) > 2.0 * fit.weighting.blur**2:
        return True
    return any(effect.line and effect.line.clock == "channels" for _, effect, _ in fit.chain.active("channels"))
