"""offset_drift: the offsets change linearly with temperature, counted from 25 C."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.hall.offset import add
from twin.motion import NOMINAL_C, Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    warm = 0.01 * (motion.temperature_c - NOMINAL_C)
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
    },
    forward=forward,
    needs=frozenset({"temperature_c", "two temperatures"}),
    source="linear temperature coefficient of the offset; the paper's future work",
    signature="order 1 times (T - 25)",
)
