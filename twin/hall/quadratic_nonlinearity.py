"""quadratic_nonlinearity: each channel answers with c + q c^2."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal + 0.01 * np.asarray(values["q_percent"]) * signal**2


QUADRATIC_NONLINEARITY = Effect(
    name="quadratic_nonlinearity",
    stage="hall",
    acts_on="channels",
    params={
        # c + q c^2 in both channels is no odd function: no value of q makes it one in the mirrored chain.
        "q_percent": Param(
            unit="%",
            null=0.0,
            lower=-30.0,
            upper=30.0,
            doc="q = K1 mag / K2, of amplitude",
            typical=0.2,
            field_power=1.0,
            mirror=0,
            scatter=0.3,
        )
    },
    forward=forward,
    source="paper, Eq. 2 and 5, normalised by K2 mag",
    signature="orders 1 and 3, locked to the axes",
    baseline=True,
)
