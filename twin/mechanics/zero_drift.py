"""zero_drift: slow creep of the zero, first order in time; a long time constant makes it linear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import Array, radians
from twin.drawing import log_span
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    # From the earliest reading, which is the first unless the clock was set back meanwhile.
    elapsed = motion.time_s - np.min(motion.time_s)
    duration = np.maximum(np.max(elapsed), 1e-12)
    # The amplitude is what the zero moves by over this record, whatever the time constant.
    tau: Array = np.maximum(values["time_constant_s"], 1e-9)
    reach = -np.expm1(-duration / tau)
    course: Array = -np.expm1(-elapsed / tau) / reach
    return signal + radians(values["amplitude_deg"]) * course


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    duration = float(np.ptp(motion.time_s)) or 1.0
    return [{"time_constant_s": duration * factor} for factor in (0.03, 0.06, 0.12, 0.25, 0.5, 1.0, 30.0)]


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """From a drift that has long ended to one that is still a straight line."""
    return {"time_constant_s": float(np.ptp(motion.time_s)) * log_span(uniform[:, 2], 0.1, 2.0)}


ZERO_DRIFT = Effect(
    name="zero_drift",
    stage="mechanics",
    acts_on="shaft",
    params={
        "amplitude_deg": Param(
            unit="deg", null=0.0, lower=-20.0, upper=20.0, doc="movement over the whole record", owner="recording"
        ),
        "time_constant_s": Param(
            unit="s",
            null=1e3,
            lower=1e-3,
            upper=1e9,
            doc="first-order time constant",
            role="shape",
            typical=1e3,
            owner="recording",
        ),
    },
    forward=forward,
    needs=frozenset({"a reference", "time_s"}),
    shapes=shapes,
    zoomed=("time_constant_s",),
    fitted_shapes=("time_constant_s",),
    record_wide=True,
    drawing=drawing,
    source="first-order relaxation (thermal settling or creep of a mount)",
    signature="order 0, monotone in time",
)
