"""Observations in the cosine basis, where noise is nearly independent from coefficient to coefficient.

Masked rows count as zero. Angles are divided by their rows' scale; radii are not: the radius need not be loud where
the angle is.
"""

from __future__ import annotations

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


def to_rows(observations: Observations, coefficients: Array) -> Array:
    """Back from cosine coefficients (..., n) to the rows (..., n), as they were weighed."""
    return spectrum.to_rows(coefficients, observations.lengths)
