"""quadratic_nonlinearity: each channel answers with c + q c^2."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion

USUAL_PERCENT = 0.3
"""Half width of the range over which devices of one kind differ in it."""
FAR_PERCENT = 1.0
"""Standard deviation of what is known of it before any sweep, three times the usual half width.

In an angle alone it makes orders 1 and 3, as offsets and a magnet's harmonic do: together these fit at any size of it.
The sensors of five measured sets have 0.15 % at most. A sweep that tells it to 0.1 % draws one of 3 % in by 0.03 %.
"""


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
            scatter=USUAL_PERCENT,
            prior_sd=FAR_PERCENT,
            prior_mean=0.0,
        )
    },
    forward=forward,
    source="paper, Eq. 2 and 5, normalised by K2 mag",
    signature="orders 1 and 3, locked to the axes",
    baseline=True,
)
