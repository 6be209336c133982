"""saturation: the concentrator's flux falls behind the field as the field grows."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal - 0.01 * np.asarray(values["k_percent"]) * (signal * signal * signal)


SATURATION = Effect(
    name="saturation",
    stage="concentrator",
    acts_on="channels",
    params={
        # The next odd term of a magnetisation curve that bends down: it grows with the square of the field.
        "k_percent": Param(
            unit="%",
            null=0.0,
            lower=-30.0,
            upper=30.0,
            doc="loss at full amplitude, c - k c^3",
            typical=0.5,
            allowed=(0.0, 30.0),
            field_power=2.0,
        )
    },
    forward=forward,
    needs=frozenset({"one turn"}),
    source="leading odd term of the magnetisation curve of a soft magnetic disk; paper, section 2.2.4",
    signature="order 4, phase locked to the sensor axes (sin 4a); order 4 in the radius",
)
