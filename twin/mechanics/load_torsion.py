"""load_torsion: the torque that accelerates what hangs on the shaft twists it between reference and magnet."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import KRPM, Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    twisted = signal - radians(values["deg_per_krpm_per_s"]) * motion.acceleration_rad_s2 / KRPM
    return twisted + radians(values["deg_per_A"]) * motion.current_a


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
            aside=True,
        ),
        # The motor's torque goes with its current: where that is recorded it tells of drag and load too.
        "deg_per_A": Param(
            unit="deg/A",
            null=0.0,
            lower=-90.0,
            upper=90.0,
            doc="twist by the torque of an ampere",
            role="level",
            typical=0.05,
            aside=True,
            sought=(-90.0, 90.0),
        ),
    },
    forward=forward,
    needs=frozenset({"a reference", "varying speed|two currents"}),
    record_wide=True,
    source="torsion of a shaft of stiffness c under the torque J dw/dt of the inertia J beyond it: J/c dw/dt; "
    "a motor's torque in proportion to its current",
    signature="order 0, minus the angular acceleration, or times the current",
)
