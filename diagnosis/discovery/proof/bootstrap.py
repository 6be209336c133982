"""Simulated residuals: the noise that a fit has found, behind the fit's own stairs, on the measured motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise.estimate import estimated
from diagnosis.discovery.fitting.noise.rounding import ahead_of_stairs, coarsest_stair
from diagnosis.discovery.marks.outliers import far_out
from twin.angles import Array, wrap
from twin.catalogue import find
from twin.hall.noise import NOISE, parameters
from twin.noise.description import Noise
from twin.noise.sequences import draw, turned


def noise_of(fit: Fit) -> Noise:
    """The noise of a fit's readings, as it stands behind all stairs."""
    return estimated(fit, limit_rad=far_out(fit.residual[0], fit.settings) + coarsest_stair(fit.chain))


def row_scale(fit: Fit, noise: Noise) -> Array | float:
    """RMS of each row (n,) against that of a row at null conditions, beside the rows' own scale in the fit."""
    return 1.0 if noise.scale.even else noise.scale.of(fit.linear.motion, fit.linear.sensor_angle)


def twin_parameters(fit: Fit, noise: Noise) -> dict[str, float]:
    """The parameters with which the twin's own noise simulates that of a fit, beside the fit's stairs and spreads."""
    ahead = ahead_of_stairs(fit, noise)
    # What causes in the spread add is white, and nothing in the quietest rows.
    variance = (fit.observations.scale / fit.observations.level)[fit.observations.usable] ** 2
    quietest = float(np.min(variance))
    coloured = min((1.0 - ahead.white_share) / (quietest * float(np.mean(1.0 / variance))), 1.0)
    return parameters(replace(ahead, rms_rad=ahead.rms_rad * np.sqrt(quietest), white_share=1.0 - coloured))


def simulated(fit: Fit, noise: Noise, *, count: int, rng: np.random.Generator) -> Array:
    """Residuals (count, n) [rad] of sweeps simulated at a fit's parameters, before they are fitted themselves.

    ``noise`` is that ahead of the stairs.
    """
    drawn = [draw(rng, (count, length), noise.spectrum(length), dof=noise.dof) for length in fit.observations.lengths]
    unit = np.concatenate(drawn, axis=-1)
    return _behind_stairs(fit, noise.rms_rad * unit * (fit.observations.scale * row_scale(fit, noise)))


def _behind_stairs(fit: Fit, noise: Array) -> Array:
    """Residuals (count, n) [rad] of readings whose noise (count, n) [rad] turns the channels ahead of all stairs."""
    chain, linear = fit.chain, fit.linear
    stepped = any(effect.line and effect.line.clock == "channels" for _, effect, _ in chain.active("channels"))
    if not stepped and not any(effect.footprint == "values" for _, effect, _ in chain.active("angle")):
        return noise
    signal = (linear.sensor_angle + noise)[:, None]
    if stepped:
        # The channels' stairs want the noise ahead of them.
        places = chain.places()
        signal = turned(linear.at(find(NOISE.name, chain.effects)).signal, noise)
        for _, effect, values in chain.active("channels"):
            if places[effect.name, "channels"] > places[NOISE.name, "channels"]:
                signal = effect.forward(signal, linear.motion, values, None)
        signal = np.arctan2(signal[:, 1:], signal[:, :1])
    for _, effect, values in chain.active("angle"):
        signal = effect.forward(signal, linear.motion, values, None)
    signal = chain.output_sense * signal
    for _, effect, values in chain.active("word"):
        signal = effect.forward(signal, linear.motion, values, None)
    return wrap(signal[:, 0] - linear.angle)
