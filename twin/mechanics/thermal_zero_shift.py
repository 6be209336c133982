"""thermal_zero_shift: the frame that holds sensor or reference expands and turns it, linearly in temperature."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import NOMINAL_C, Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal + radians(values["deg_per_K"]) * (motion.temperature_c - NOMINAL_C)


THERMAL_ZERO_SHIFT = Effect(
    name="thermal_zero_shift",
    stage="mechanics",
    acts_on="shaft",
    params={"deg_per_K": Param(unit="deg/K", null=0.0, lower=-1.0, upper=1.0, doc="turn of the zero", typical=0.002)},
    forward=forward,
    needs=frozenset({"a reference", "temperature_c", "two temperatures"}),
    source="thermal expansion of a mount whose halves differ: (difference of coefficients) x length / lever arm",
    signature="order 0 times (T - 25)",
)
