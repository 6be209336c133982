"""The noise of a fit, whole: its colour, then the distribution and the scale of what whitening by it leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.coefficients import to_rows
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise.colour import coloured
from diagnosis.discovery.fitting.noise.distribution import distribution
from diagnosis.discovery.fitting.noise.rounding import stairs_rule
from twin.angles import Array
from twin.noise.description import Noise
from twin.noise.row_scale import RowScale, conditions

_NEEDS = {
    "backward_percent": "both directions",
    "percent_per_K": "two temperatures",
    "percent_per_rpm": "two speeds",
    "angle_percent": "one turn",
}
"""What a motion must provide to show that the RMS depends on a condition."""


def estimated(fit: Fit, *, limit_rad: float) -> Noise:
    """The noise of the readings in use, as it stands behind all stairs.

    Parameters
    ----------
    fit : Fit
        Its residual is the noise; its rows' own scale is that of causes that have been found, and is set aside here.
    limit_rad : float
        Distance from its neighbours [rad] beyond which a reading has been left out of the fit.

    Returns
    -------
    Noise
        Heavy tails and a scale that depends on conditions only where the likelihood ratio leaves no doubt of them.
    """
    noise = coloured(fit)
    use = fit.observations.usable
    if noise.rms_rad < np.radians(fit.settings.smallest_rms_deg) or stairs_rule(fit):
        return noise
    provided = fit.observations.motion.provides
    shown = {
        name: rows[:, use]
        for name, rows in conditions(fit.observations.motion, fit.linear.sensor_angle).items()
        if _NEEDS[name] in provided
    }
    log_p = fit.settings.effect_log_p(1 + len(shown))
    white = whitened_rows(fit, noise)[use]
    limit = limit_rad / peak(noise, len(use))
    if 2 * np.count_nonzero(np.abs(white) < limit) < white.size:
        # A smooth residual is its own median: most of it then lies beyond, and is structure rather than noise.
        return noise
    found = distribution(white, shown, limit=limit, log_p=log_p)
    if not found.parts:
        return noise
    # The residual has lost to the free parameters what the restricted likelihood has put back.
    lost = noise.rms_rad / float(np.sqrt(np.mean(white**2)))
    return replace(noise, rms_rad=lost * found.rms, dof=found.dof, scale=RowScale.from_slopes(found.slopes))


def whitened_rows(fit: Fit, noise: Noise) -> Array:
    """Residual (n,) [rad] of the angle over the rows, without the noise's colour and the rows' own scale."""
    return to_rows(fit.observations, fit.cosine_residual[0] / np.sqrt(fit.observations.spectrum(noise)))


def peak(noise: Noise, n: int) -> float:
    """How much of one innovation of the noise stands in the very reading where it happens; 1: white noise."""
    return float(np.mean(np.sqrt(noise.spectrum(n))))
