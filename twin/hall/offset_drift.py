"""offset_drift: the offsets change with the sensor's temperature, counted from 25 C."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.hall.body_temperature import warmth
from twin.hall.offset import add
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    warm = 0.01 * warmth(motion, values.get("lag_s", 0.0), values.get("bend_per_K", 0.0))
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
        # Packages follow in seconds, sockets and boards in minutes: an hour is more than a record waits for.
        "lag_s": Param(
            unit="s",
            null=0.0,
            lower=0.0,
            upper=3600.0,
            doc="time constant by which the sensor is behind the recorded temperature",
            role="shape",
            typical=30.0,
            aside=True,
            detail=True,
        ),
        # At the bounds what is 50 K warmer has drifted by twice as much, or by nothing: what bends more is another law.
        "bend_per_K": Param(
            unit="1/K",
            null=0.0,
            lower=-0.02,
            upper=0.02,
            doc="by which share of itself the drift grows with each kelvin above 25 C",
            role="shape",
            typical=0.001,
            aside=True,
            detail=True,
        ),
    },
    forward=forward,
    needs=frozenset({"temperature_c", "two temperatures"}),
    source="temperature coefficient of the offset, of first and second order; first-order thermal lag; the paper's "
    "future work",
    signature="order 1 times (T - 25)",
)
