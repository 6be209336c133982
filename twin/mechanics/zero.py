"""zero: the angle between the reference's zero and the sensor's x axis."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal + radians(values["zero_deg"])


ZERO = Effect(
    name="zero",
    stage="mechanics",
    acts_on="field",
    params={
        "zero_deg": Param(
            unit="deg",
            null=0.0,
            lower=-360.0,
            upper=360.0,
            doc="reference zero to sensor x axis",
            scatter=180.0,
            owner="mounting",
        )
    },
    forward=forward,
    source="definition; paper, Eq. 1: the standard angle is counted from the sensor's x axis",
    signature="order 0",
    baseline=True,
)
