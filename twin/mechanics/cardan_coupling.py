"""cardan_coupling: an angled universal joint between reference and magnet turns the magnet unevenly."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal + radians(values["amplitude_deg"]) * np.sin(2.0 * signal + radians(values["phase_deg"]))


CARDAN_COUPLING = Effect(
    name="cardan_coupling",
    stage="mechanics",
    acts_on="shaft",
    params={
        "amplitude_deg": Param(unit="deg", null=0.0, lower=0.0, upper=20.0, doc="amplitude of the uneven turning"),
        "phase_deg": Param(unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="its phase", role="phase"),
    },
    forward=forward,
    needs=frozenset({"a reference", "vx|two mountings", "one turn"}),
    # It is told from the radius alone, which a saturating disk and a misplaced magnet change too (400 to 1).
    handicap=6.0,
    source="Cardan joint at angle b: tan(out) = cos(b) tan(in), so the amplitude is tan^2(b/2) to leading order",
    signature="order 2 in the angle error, absent from the x-y ellipse",
)
