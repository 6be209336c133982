"""index_slip: the reference's zero jumps, once or several times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import Array, radians
from twin.drawing import span
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    after = motion.time_s >= np.asarray(values["time_s"])
    # A zero that moves on by a step makes every later reading fall by it, and the error e rise.
    return signal - radians(values["step_deg"]) * after


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    rows = np.unique(np.linspace(2, len(motion) - 2, min(len(motion) - 3, 64)).astype(int))
    return [{"time_s": float(motion.time_s[row])} for row in rows]


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """Well within the record."""
    start, end = motion.time_s[0], motion.time_s[-1]
    return {"time_s": start + (end - start) * span(uniform[:, 2], 0.2, 0.8)}


INDEX_SLIP = Effect(
    name="index_slip",
    stage="reference",
    acts_on="reference",
    params={
        "step_deg": Param(unit="deg", null=0.0, lower=-180.0, upper=180.0, doc="the jump", owner="recording"),
        "time_s": Param(
            unit="s",
            null=0.0,
            lower=-1e12,
            upper=1e12,
            doc="its instant; the row without time stamps",
            role="shape",
            owner="recording",
        ),
    },
    forward=forward,
    shapes=shapes,
    zoomed=("time_s",),
    repeatable=True,
    drawing=drawing,
    needs=frozenset({"time_s"}),
    source="definition: an incremental encoder that loses or gains counts",
    signature="a step in order 0, or several",
)
