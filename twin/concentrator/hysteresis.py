"""hysteresis: the concentrator's remanence makes the field angle lag the direction of turning."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import Array, radians
from twin.drawing import log_span
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def lag(motion: Motion, lag_rad: Array, memory_rad: Array) -> Array:
    """Lag angle (..., n) [rad]: dL/d|theta| = (-d h - L)/memory, steady at the first row."""
    out = np.empty(np.broadcast_shapes(np.shape(lag_rad), np.shape(memory_rad), (len(motion),)))
    state = None
    for first, last, way in motion.segments:
        target = -way * lag_rad
        if state is None:
            out[..., first:last] = target
        else:
            path = motion.travel_rad[first:last] - motion.travel_rad[first - 1]
            out[..., first:last] = target + (state - target) * np.exp(-path / memory_rad)
        state = out[..., last - 1 : last]
    return out


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    memory = radians(np.maximum(values["memory_deg"], 1e-3))
    return signal + lag(motion, np.atleast_1d(radians(values["lag_deg"])), np.atleast_1d(memory))


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    return [{"memory_deg": memory} for memory in (0.5, 2.0, 5.0, 12.0, 25.0, 50.0)]


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """A memory of degrees."""
    return {"memory_deg": log_span(uniform[:, 2], 2.0, 30.0)}


HYSTERESIS = Effect(
    name="hysteresis",
    stage="concentrator",
    acts_on="shaft",
    params={
        # The coercive field is the material's, in A/m: the angle by which it holds the field back is its share of it.
        "lag_deg": Param(
            unit="deg",
            null=0.0,
            lower=0.0,
            upper=5.0,
            doc="steady lag",
            field_power=-1.0,
        ),
        "memory_deg": Param(
            unit="deg",
            null=10.0,
            lower=0.05,
            upper=90.0,
            doc="travel over which it relaxes",
            role="shape",
            typical=10.0,
        ),
    },
    forward=forward,
    needs=frozenset({"both directions"}),
    shapes=shapes,
    zoomed=("memory_deg",),
    fitted_shapes=("memory_deg",),
    drawing=drawing,
    source="first-order return-point memory in the angle (Dahl's friction model, 1968, in angular form)",
    signature="-h d, relaxing exponentially after a reversal",
)
