"""Causes that follow the motor's current, which changes by steps during a record."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .baseline import Injected, Setting
from .motion import Array, Motion

LEVELS_A = np.array([1.0, 4.0, 2.0, 5.0, 0.5])
"""One after the other, each for a fifth of the record."""
FIELD_MT = 50.0
"""What the answer counts millitesla against where no magnet is described."""


def current_A(motion: Motion) -> Array:
    """The motor's current (n,)."""
    rows = len(motion.time_s)
    return np.asarray(LEVELS_A[np.arange(rows) * LEVELS_A.size // rows])


def plan_motor_field(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: the largest angle at the largest current."""
    towards = float(rng.uniform(0.0, 2.0 * np.pi))
    size = FIELD_MT * np.radians(strength) / LEVELS_A.max()
    parameters = {"bx_mT_per_A": float(size * np.cos(towards)), "by_mT_per_A": float(size * np.sin(towards))}
    return Injected("motor_field", strength, parameters, {"current_a": current_A(setting.motion)})


def motor_field(field: tuple[Array, Array], by_name: Mapping[str, Injected]) -> tuple[Array, Array]:
    """The field (two components, of the magnet's own) with that of the winding."""
    if "motor_field" not in by_name:
        return field
    told = by_name["motor_field"]
    share = told.hidden["current_a"] / FIELD_MT
    return field[0] + told.parameters["bx_mT_per_A"] * share, field[1] + told.parameters["by_mT_per_A"] * share


def plan_load_torsion(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: the twist at the largest current, either way."""
    way = float(rng.choice((-1.0, 1.0)))
    return Injected(
        "load_torsion",
        strength,
        {"deg_per_A": way * strength / float(LEVELS_A.max())},
        {"current_a": current_A(setting.motion)},
    )


def load_torsion(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """The shaft between reference and magnet under the motor's torque."""
    return shaft + injected.parameters["deg_per_A"] * injected.hidden["current_a"]
