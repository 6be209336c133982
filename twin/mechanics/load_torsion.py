"""load_torsion: the torque that accelerates what hangs on the shaft twists it between reference and magnet."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import RPM, Motion

KRPM_RAD_S = 1000.0 * RPM
"""1000 rpm in rad/s."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal - radians(values["deg_per_krpm_per_s"]) * motion.acceleration_rad_s2 / KRPM_RAD_S


LOAD_TORSION = Effect(
    name="load_torsion",
    stage="mechanics",
    acts_on="shaft",
    params={
        "deg_per_krpm_per_s": Param(
            unit="deg/(krpm/s)",
            null=0.0,
            lower=-1e3,
            upper=1e3,
            doc="inertia over stiffness: twist at an acceleration of 1000 rpm a second; negative: the magnet is at "
            "the driven end",
        ),
    },
    forward=forward,
    needs=frozenset({"moving shaft", "varying speed"}),
    record_wide=True,
    source="torsion of a shaft of stiffness c under the torque J dw/dt of the inertia J beyond it: J/c dw/dt",
    signature="order 0, minus the angular acceleration",
)
