"""phase: the y channel senses the angle a + beta instead of a."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, channels_of, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return channels_of(signal[..., :1, :], signal[..., 1:, :] + radians(values["beta_deg"]))


PHASE = Effect(
    name="phase",
    stage="hall",
    acts_on="field",
    params={
        "beta_deg": Param(
            unit="deg", null=0.0, lower=-45.0, upper=45.0, doc="orthogonality error of y against x", scatter=0.2
        )
    },
    forward=forward,
    source="paper, Eq. 1",
    signature="order 2, cos 2a, and order 0",
    baseline=True,
)
