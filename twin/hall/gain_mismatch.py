"""gain_mismatch: the channels differ in sensitivity; only Ay/Ax is visible in an angle, so Ax = 1 is the gauge."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, channels_of
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def scale_y(signal: Array, ratio: Array) -> Array:
    """Signal (..., 2, n) with its y channel multiplied by ratio, broadcast against (..., 1, n)."""
    return channels_of(signal[..., :1, :], signal[..., 1:, :] * ratio)


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return scale_y(signal, np.asarray(values["ratio"], dtype=np.float64))


GAIN_MISMATCH = Effect(
    name="gain_mismatch",
    stage="hall",
    acts_on="channels",
    params={"ratio": Param(unit="1", null=1.0, lower=0.2, upper=5.0, doc="gain ratio", typical=0.003, scatter=0.01)},
    forward=forward,
    source="paper, Eq. 1",
    signature="order 2, sin 2a",
    baseline=True,
)
