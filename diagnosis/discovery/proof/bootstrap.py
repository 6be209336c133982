"""Simulated residuals: the noise that a fit has found, behind the fit's own stairs, on the measured motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise_colour import Colour
from diagnosis.discovery.fitting.noise_model import to_rows
from twin.angles import Array, wrap
from twin.catalogue import find

_QUIETEST = 0.02
"""Least noise ahead of the stairs at any frequency, as a share of its mean."""


@dataclass(frozen=True, eq=False)
class NoiseAhead:
    """Noise ahead of the stairs: its spectrum (n,) of mean 1 over the cosine coefficients, and its RMS [rad]."""

    spectrum: Array
    rms: float


def ahead_of_stairs(fit: Fit, colour: Colour) -> NoiseAhead:
    """The noise of a fit's readings before they were rounded: rounding adds white noise of its own."""
    rms = float(np.sqrt(np.mean((fit.residual[0] / fit.evidence.scale)[fit.evidence.usable] ** 2)))
    blur = fit.setting.blur
    if not 0.0 < blur < rms:
        return NoiseAhead(colour.spectrum, rms)
    ahead = colour.spectrum * rms**2 - (rms**2 - blur**2)
    ahead = np.maximum(ahead, _QUIETEST * blur**2)
    return NoiseAhead(ahead / np.mean(ahead), blur)


def simulated(fit: Fit, noise: NoiseAhead, *, count: int, rng: np.random.Generator) -> Array:
    """Residuals (count, n) [rad] of sweeps simulated at a fit's parameters, before they are fitted themselves."""
    draws = rng.standard_normal((count, len(fit.evidence)))
    turned = noise.rms * to_rows(np.sqrt(noise.spectrum) * draws) * fit.evidence.scale
    return _behind_stairs(fit, turned)


def _behind_stairs(fit: Fit, noise: Array) -> Array:
    """Residuals (count, n) [rad] of readings whose noise (count, n) [rad] turns the channels ahead of all stairs."""
    chain, linear = fit.chain, fit.linear
    stepped = any(effect.line and effect.line.clock == "channels" for _, effect, _ in chain.active("channels"))
    if not stepped and not any(effect.footprint == "values" for _, effect, _ in chain.active("angle")):
        return noise
    signal = (linear.sensor_angle + noise)[:, None]
    if stepped:
        # The channels' stairs want the noise ahead of them.
        place = [effect.name for effect in chain.effects].index("noise")
        x, y = linear.at(find("noise", chain.effects)).signal
        cos, sin = np.cos(noise), np.sin(noise)
        signal = np.stack([x * cos - y * sin, x * sin + y * cos], axis=1)
        for _, effect, values in chain.active("channels"):
            if chain.effects.index(effect) > place:
                signal = effect.forward(signal, linear.motion, values, None)
        signal = np.arctan2(signal[:, 1:], signal[:, :1])
    for _, effect, values in chain.active("angle"):
        signal = effect.forward(signal, linear.motion, values, None)
    return wrap(chain.output_sense * signal[:, 0] - linear.angle)
