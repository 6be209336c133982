"""The temperature of the sensor's own body, by which its plates and amplifiers go."""

from __future__ import annotations

import itertools

import numpy as np

from twin.angles import Array
from twin.effect import Parameters
from twin.motion import NOMINAL_C, Motion
from twin.param import Param

BODY = {
    # Packages follow in seconds, sockets and boards in minutes: an hour is more than a record waits for.
    "lag_s": Param(
        unit="s",
        null=0.0,
        lower=0.0,
        upper=3600.0,
        doc="time constant by which the sensor is behind the recorded temperature",
        role="shape",
        typical=30.0,
        aside=True,
        detail=True,
    ),
    # At the bounds what is 50 K warmer has drifted by twice as much, or by nothing: what bends more is another law.
    "bend_per_K": Param(
        unit="1/K",
        null=0.0,
        lower=-0.02,
        upper=0.02,
        doc="by which share of itself the drift grows with each kelvin above 25 C",
        role="shape",
        typical=0.001,
        aside=True,
        detail=True,
    ),
}
"""What a drift with the temperature of the sensor's body has beside its slope."""


def drifted(motion: Motion, values: Parameters) -> Array:
    """:func:`warmth` with the lag and the bend that ``values`` give, or without."""
    return warmth(motion, np.asarray(values.get("lag_s", 0.0)), np.asarray(values.get("bend_per_K", 0.0)))


def warmth(motion: Motion, lag_s: Array, bend_per_K: Array) -> Array:
    """By how much a quantity has moved since 25 C whose slope there is 1 per kelvin, (..., n).

    The body follows the recorded temperature by a first-order lag, and the quantity bends with the body's temperature:
    ``w (1 + bend w)``, w [K] above 25 C. Both broadcast against (..., n); without time the body is never behind.
    """
    warm = motion.temperature_c - NOMINAL_C + _behind(motion, np.asarray(lag_s, dtype=np.float64))
    return np.asarray(warm * (1.0 + np.asarray(bend_per_K) * warm))


def _behind(motion: Motion, lag_s: Array) -> Array:
    """Temperature of the body less the recorded one (..., n) [K]: it has settled at the first reading.

    What is recorded at a reading is taken to hold since the one before.
    """
    out = np.zeros((*lag_s.shape[:-1], len(motion)))
    changes = np.flatnonzero(np.diff(motion.temperature_c)) + 1
    if not np.any(lag_s) or "time_s" not in motion.provides:
        return out
    rate = 1.0 / np.maximum(lag_s, 1e-9)
    for first, end in itertools.pairwise([*changes, len(motion)]):
        step = motion.temperature_c[first] - motion.temperature_c[first - 1]
        passed = np.maximum(motion.time_s[first:end] - motion.time_s[first - 1], 0.0)
        out[..., first:end] = (out[..., first - 1 : first] - step) * np.exp(-passed * rate)
    return out
