"""Observations in the cosine basis, where noise is nearly independent from coefficient to coefficient.

Masked rows count as zero. Angles are divided by their rows' scale; radii are not: the radius need not be loud where
the angle is.
"""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.observations import Observations
from twin.angles import Array
from twin.noise import spectrum


def to_cosine(observations: Observations, values: Array) -> Array:
    """Angles (..., n) over the rows as cosine coefficients (..., n)."""
    return spectrum.to_cosine(values * (observations.usable / observations.scale), observations.lengths)


def observables_to_cosine(observations: Observations, values: Array) -> Array:
    """Observables (..., O, n), the angle first, as cosine coefficients (..., O, n)."""
    out = values * observations.usable
    out[..., 0, :] /= observations.scale
    return spectrum.to_cosine(out, observations.lengths)


def radius_to_cosine(observations: Observations, values: Array) -> Array:
    """Radii (..., n) as cosine coefficients (..., n)."""
    return spectrum.to_cosine(values * observations.usable, observations.lengths)


def without_motion(observations: Observations, angles: Array) -> Array:
    """Angles (n,) less what the shaft may have done beside an estimated motion; as they are, NaN too, where none was.

    What of them is slower than the readings tell of, and what torques may have made, says nothing of a sensor.
    """
    estimated = observations.motion.estimated
    if estimated is None:
        return angles
    known = np.isfinite(angles) & observations.usable
    left = np.where(np.isfinite(angles), angles, 0.0)
    left = left if observations.loose is None else observations.loose.whitened(left)
    coefficients = spectrum.to_cosine(np.where(known, left, 0.0), estimated.lengths)
    moved = spectrum.to_rows(coefficients * (1.0 - 1.0 / np.sqrt(1.0 + estimated.spectrum)), estimated.lengths)
    return np.where(np.isfinite(angles), left - moved, np.nan)


def to_rows(observations: Observations, coefficients: Array) -> Array:
    """Back from cosine coefficients (..., n) to the rows (..., n), as they were weighed."""
    return spectrum.to_rows(coefficients, observations.lengths)
