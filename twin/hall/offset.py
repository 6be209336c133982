"""offset: a constant on each channel."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, channels_of
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def add(signal: Array, x: Array | float, y: Array | float) -> Array:
    """Signal (..., 2, n) with x and y, broadcast against (..., 1, n), added to its channels."""
    return channels_of(signal[..., :1, :] + x, signal[..., 1:, :] + y)


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return add(signal, 0.01 * np.asarray(values["x_percent"]), 0.01 * np.asarray(values["y_percent"]))


OFFSET = Effect(
    name="offset",
    stage="hall",
    acts_on="channels",
    # The plates and the front-end add volts, whatever the field is.
    params={
        "x_percent": Param(
            unit="%", null=0.0, lower=-90.0, upper=90.0, doc="offset x", typical=0.2, field_power=-1.0, scatter=1.0
        ),
        "y_percent": Param(
            unit="%",
            null=0.0,
            lower=-90.0,
            upper=90.0,
            doc="offset y",
            typical=0.2,
            field_power=-1.0,
            mirror=-1,
            scatter=1.0,
        ),
    },
    forward=forward,
    source="paper, Eq. 1; each offset counted in amplitudes of its own channel",
    signature="order 1",
    baseline=True,
)
