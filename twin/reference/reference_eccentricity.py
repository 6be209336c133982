"""reference_eccentricity: the reference's disk sits off the shaft's axis."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal + radians(values["amplitude_deg"]) * np.sin(signal + radians(values["phase_deg"]))


REFERENCE_ECCENTRICITY = Effect(
    name="reference_eccentricity",
    stage="reference",
    acts_on="reference",
    params={
        "amplitude_deg": Param(unit="deg", null=0.0, lower=0.0, upper=20.0, doc="amplitude in the reference"),
        "phase_deg": Param(unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="phase", role="phase"),
    },
    forward=forward,
    needs=frozenset({"a reference", "vx|two mountings|two air gaps", "one turn"}),
    # Every magnet is misplaced a little; that the reference errs as well is a second assumption (400 to 1).
    handicap=6.0,
    source="geometry: a graduation of radius R centred e off the axis reads e/R sin(theta + psi) too much",
    signature="order 1 in the angle error, absent from the x-y ellipse",
)
