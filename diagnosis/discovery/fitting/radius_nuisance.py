"""What the channels' amplitude may do for reasons of its own, which tells nothing about an angle."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.observations import Observations
from twin.angles import Array
from twin.motion import NOMINAL_C


def without_nuisance(observations: Observations, columns: Array) -> Array:
    """Columns (..., O, n) whose radius is free of a common scale and its drift with temperature.

    These are as the rows in use tell them, and are taken off the others too: whether such a row is in its place is
    judged by what is left of it.
    """
    if observations.observables == 1:
        return columns
    everywhere = np.stack(_nuisance(observations))
    basis, factors = np.linalg.qr((everywhere * observations.usable).T)
    # Of a recording that is left out altogether nothing tells the scale.
    full = np.linalg.pinv(factors.T) @ everywhere
    columns = np.array(columns)
    columns[..., 1, :] -= (columns[..., 1, :] @ basis) @ full
    return columns


def _nuisance(observations: Observations) -> list[Array]:
    """A scale for each recording, and a quadratic in temperature."""
    recordings, every = observations.motion.recordings, np.ones(len(observations))
    columns = [every] if recordings is None else [every * (recordings.number == k) for k in range(len(recordings))]
    if "two temperatures" in observations.motion.provides:
        warm = (observations.motion.temperature_c - NOMINAL_C) / 50.0
        columns += [warm, warm**2]
    return columns
