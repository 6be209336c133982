"""latency: the reading is tau old when it is paired with the reference (transport delay, or a filter's group delay)."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.drawing import delay
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal - 1e-6 * np.asarray(values["delay_us"]) * motion.speed_rad_s


LATENCY = Effect(
    name="latency",
    stage="link",
    # An old reading is a reading of where the shaft was: the delay acts on the shaft angle at the sampling instant.
    acts_on="shaft",
    params={"delay_us": Param(unit="us", null=0.0, lower=-1e6, upper=1e6, doc="age of the reading", typical=20.0)},
    forward=forward,
    needs=frozenset({"two speeds|both directions", "moving shaft"}),
    drawing=delay,
    source="kinematics: e = -w tau",
    signature="order 0, minus speed times delay",
)
