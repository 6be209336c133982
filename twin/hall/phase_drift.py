"""phase_drift: the orthogonality error changes with the sensor's temperature, counted from 25 C."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.hall.body_temperature import BODY, drifted
from twin.hall.phase import forward as add_phase
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    beta_deg = np.asarray(values["deg_per_K"]) * drifted(motion, values)
    return add_phase(signal, motion, {"beta_deg": beta_deg}, rng)


PHASE_DRIFT = Effect(
    name="phase_drift",
    stage="hall",
    acts_on="field",
    params={
        "deg_per_K": Param(unit="deg/K", null=0.0, lower=-0.5, upper=0.5, doc="drift of beta", typical=0.002),
        **BODY,
    },
    forward=forward,
    needs=frozenset({"temperature_c", "two temperatures"}),
    source="temperature coefficient of the orthogonality error, of first and second order; first-order thermal lag; "
    "the paper's future work",
    signature="order 2 (cos 2a) and order 0, times (T - 25)",
)
