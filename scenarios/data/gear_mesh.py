"""gear_mesh: each tooth of a pinion on the shaft twists it, by less on the flank that carries the load backward."""

from __future__ import annotations

import numpy as np

from twin import Array, Effect, Motion, Param, Parameters

TEETH = 13


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    twist_deg = np.where(motion.direction > 0.0, values["forward_deg"], values["backward_deg"])
    wave: Array = np.sin(TEETH * motion.shaft_rad + np.radians(values["phase_deg"]))
    return signal + np.radians(twist_deg) * wave


EFFECT = Effect(
    name="gear_mesh",
    stage="mechanics",
    acts_on="shaft",
    params={
        "forward_deg": Param(unit="deg", null=0.0, lower=-9.0, upper=9.0, doc="twist on the way forward"),
        "backward_deg": Param(unit="deg", null=0.0, lower=-9.0, upper=9.0, doc="twist on the way back"),
        "phase_deg": Param(unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="where the teeth stand", role="phase"),
    },
    forward=forward,
    needs=frozenset({"one turn", "both directions"}),
    source="drawing of the drive: a pinion of 13 teeth between reference and magnet",
    signature="order 13, larger in one direction than in the other",
)
