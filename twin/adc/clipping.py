"""clipping: a channel cannot exceed the converter's range."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import Array
from twin.drawing import YARDSTICK_DEG
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    level = 0.01 * np.asarray(values["level_percent"])
    return np.clip(signal, -level, level)


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    # Near the amplitude half a percent halves or doubles what is cut off: a coarser grid would step over it.
    levels = (*np.arange(40.0, 84.0, 2.0), *np.linspace(84.0, 116.0, 65))
    return [{"level_percent": float(level)} for level in levels]


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """c - L lost near an axis turns the angle by up to about 0.5 (1 - L)^1.5: the yardstick is 2 %."""
    return {"level_percent": 100.0 - 2.0 * (strength_deg / YARDSTICK_DEG) ** (2.0 / 3.0)}


CLIPPING = Effect(
    name="clipping",
    stage="adc",
    acts_on="channels",
    params={
        "level_percent": Param(
            unit="%",
            null=1000.0,
            lower=30.0,
            upper=1000.0,
            doc="the limit, in amplitudes of x",
            role="level",
            typical=2.0,
            field_power=-1.0,
        )
    },
    forward=forward,
    needs=frozenset({"one turn"}),
    shapes=shapes,
    zoomed=("level_percent",),
    fitted_shapes=("level_percent",),
    drawing=drawing,
    source="definition: full scale of the converter below the signal's amplitude",
    signature="four narrow spots, at the axes",
)
