"""gain_drift: the ratio of the sensitivities changes with the sensor's temperature, counted from 25 C."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.hall.body_temperature import BODY, drifted
from twin.hall.gain_mismatch import scale_y
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return scale_y(signal, 1.0 + 0.01 * np.asarray(values["percent_per_K"]) * drifted(motion, values))


GAIN_DRIFT = Effect(
    name="gain_drift",
    stage="hall",
    acts_on="channels",
    params={
        "percent_per_K": Param(
            unit="%/K", null=0.0, lower=-0.7, upper=0.7, doc="drift of the gain ratio", typical=0.005
        ),
        **BODY,
    },
    forward=forward,
    needs=frozenset({"temperature_c", "two temperatures"}),
    source="temperature coefficient of the sensitivity ratio, of first and second order; first-order thermal lag; "
    "the paper's future work",
    signature="order 2 (sin 2a) times (T - 25)",
)
