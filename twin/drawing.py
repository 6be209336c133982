"""Pieces of which effects make their ``drawing``: parameters of training sweeps from uniform numbers in [0, 1)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import Array, radians
from twin.motion import Motion


def span(uniform: Array, low: float, high: float) -> Array:
    """Even from low to high."""
    return np.asarray(low + (high - low) * uniform)


def log_span(uniform: Array, low: float, high: float) -> Array:
    """Even in the logarithm, from low to high."""
    return np.asarray(low * (high / low) ** uniform)


def whole(uniform: Array, low: int, high: int) -> Array:
    """Whole numbers from low to high, both included."""
    return np.asarray(np.minimum(np.floor(low + (high - low + 1) * uniform), high))


def delay(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """The delay in which the fastest shaft turns by the strength, of either sign."""
    fastest = float(np.max(np.abs(motion.speed_rad_s)))
    return {"delay_us": 1e6 * radians(strength_deg) / fastest * np.where(uniform[:, 0] < 0.5, -1.0, 1.0)}
