"""offset_drift: the offsets change with the sensor's temperature, counted from 25 C."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.hall.body_temperature import BODY, drifted
from twin.hall.offset import add
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    warm = 0.01 * drifted(motion, values)
    return add(signal, np.asarray(values["x_percent_per_K"]) * warm, np.asarray(values["y_percent_per_K"]) * warm)


OFFSET_DRIFT = Effect(
    name="offset_drift",
    stage="hall",
    acts_on="channels",
    params={
        "x_percent_per_K": Param(
            unit="%/K", null=0.0, lower=-1.0, upper=1.0, doc="drift of offset x", typical=0.003, field_power=-1.0
        ),
        "y_percent_per_K": Param(
            unit="%/K",
            null=0.0,
            lower=-1.0,
            upper=1.0,
            doc="drift of offset y",
            typical=0.003,
            field_power=-1.0,
            mirror=-1,
        ),
        **BODY,
    },
    forward=forward,
    needs=frozenset({"temperature_c", "two temperatures"}),
    source="temperature coefficient of the offset, of first and second order; first-order thermal lag; the paper's "
    "future work",
    signature="order 1 times (T - 25)",
)
