"""What radius and angle may do for reasons of their own, which tells nothing about the sensor's angle."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from diagnosis.discovery.fitting.observations import Observations
from twin.angles import Array
from twin.motion import NOMINAL_C


def without_nuisance(observations: Observations, columns: Array) -> Array:
    """Columns (..., O, n) as they count: residuals, Jacobian and candidates alike.

    The radius is free of a common scale and its drift with temperature. These are as the rows in use tell them, and are
    taken off the others too: whether such a row is in its place is judged by what is left of it. Of an angle without a
    reference counts along what torques may have done to the shaft the less the more these may have.
    """
    if observations.observables == 1 and observations.loose is None:
        return columns
    columns = np.array(columns)
    if observations.loose is not None:
        columns[..., 0, :] = observations.loose.whitened(columns[..., 0, :])
    if observations.observables == 2:
        _free_of_scale(observations, columns[..., 1, :])
    return columns


def _free_of_scale(observations: Observations, radii: Array) -> None:
    """Take the scale and its drift off radii (..., n), in place."""
    basis, full = _scale(observations)
    radii -= (radii @ basis) @ full


@lru_cache(maxsize=8)
def _scale(observations: Observations) -> tuple[Array, Array]:
    """A basis (n, k) of the scale and its drift over the rows in use, and what belongs to it (k, n) over all rows."""
    everywhere = np.stack(_nuisance(observations))
    basis, factors = np.linalg.qr((everywhere * observations.usable).T)
    # Of a recording that is left out altogether nothing tells the scale.
    return basis, np.linalg.pinv(factors.T) @ everywhere


def _nuisance(observations: Observations) -> list[Array]:
    """A scale for each recording, and a quadratic in temperature."""
    recordings, every = observations.motion.recordings, np.ones(len(observations))
    columns = [every] if recordings is None else [every * (recordings.number == k) for k in range(len(recordings))]
    if "two temperatures" in observations.motion.provides:
        warm = (observations.motion.temperature_c - NOMINAL_C) / 50.0
        columns += [warm, warm**2]
    return columns
