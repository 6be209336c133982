"""Unnamed structure in the spread: a stretch of readings that is noisier than the rest."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def _burst(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    if rng is None:
        return signal
    row = np.arange(len(motion))
    inside = (row >= np.asarray(values["first_row"])) & (row <= np.asarray(values["last_row"]))
    return signal + inside * radians(values["rms_deg"]) * rng.standard_normal(signal.shape)


UNNAMED_BURST = Effect(
    name="unnamed_burst",
    stage="empirical",
    acts_on="angle",
    params={
        "first_row": Param(
            unit="row", null=0.0, lower=0.0, upper=1e9, doc="first row", role="shape", counts=True, owner="recording"
        ),
        "last_row": Param(
            unit="row", null=0.0, lower=0.0, upper=1e9, doc="last row", role="shape", counts=True, owner="recording"
        ),
        "rms_deg": Param(
            unit="deg", null=0.0, lower=0.0, upper=90.0, doc="RMS beyond the noise", role="random", owner="recording"
        ),
    },
    forward=_burst,
    footprint="spread",
    kind="noise",
    words="rows {first_row} to {last_row} scatter by {rms_deg} deg RMS beyond the noise",
    source="change of variance",
    signature="a stretch with more noise",
)
