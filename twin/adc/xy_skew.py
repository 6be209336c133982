"""xy_skew: y is sampled a moment after x (or before it), while the shaft turns."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.drawing import delay
from twin.effect import Effect, Param, Parameters
from twin.hall.offset import add
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    later = 1e-6 * np.asarray(values["delay_us"]) * motion.speed_rad_s
    return add(signal, 0.0, later)


XY_SKEW = Effect(
    name="xy_skew",
    stage="adc",
    acts_on="shaft",
    params={
        "delay_us": Param(unit="us", null=0.0, lower=-1e5, upper=1e5, doc="y sampled this much after x", typical=20.0)
    },
    forward=forward,
    # Without a reference a torque of order 2 does the same at two speeds, and friction of order 2 both ways; the
    # channels' radius tells them apart.
    needs=frozenset({"two speeds|both directions", "moving shaft", "a reference|three speeds|vx"}),
    drawing=delay,
    source="sequential conversion of x and y by one multiplexed converter",
    signature="order 0 and order 2, proportional to speed times delay",
)
