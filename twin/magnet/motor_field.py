"""motor_field: a stray field of the motor, fixed in the stator, that grows with the motor's current."""

from __future__ import annotations

from typing import Any

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.hall.offset import add
from twin.magnet.stray_field import FIELD_MT, OWN_FIELD, along_axes, beside
from twin.motion import KRPM, Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    # Where no current is recorded, it goes with the drag, and that with the speed.
    krpm, field = motion.speed_rad_s / KRPM, np.asarray(values.get("field_mT", FIELD_MT))
    bx = np.asarray(values["bx_mT_per_krpm"]) * krpm + np.asarray(values["bx_mT_per_A"]) * motion.current_a
    by = np.asarray(values["by_mT_per_krpm"]) * krpm + np.asarray(values["by_mT_per_A"]) * motion.current_a
    return add(signal, *along_axes(bx / field, by / field, motion))


def at_magnet(assembly: Any) -> Effect:
    """The effect beside a described magnet."""
    return beside(MOTOR_FIELD, assembly)


def _components(name: str, unit: str, of: str, *, sought: bool) -> dict[str, Param]:
    """Both components of the field that goes with the current, or with what the current goes with."""
    return {
        f"b{axis}_{name}": Param(
            unit=unit,
            null=0.0,
            lower=-50.0,
            upper=50.0,
            doc=f"field {of} along the sensor's {axis}",
            role="level" if sought else "strength",
            mirror=-1 if axis == "y" else None,
            aside=True,
            sought=(-50.0, 50.0) if sought else None,
            owner="bench",
        )
        for axis in "xy"
    }


_BY_CURRENT = _components("mT_per_A", "mT/A", "of an ampere", sought=True)
_BY_SPEED = _components("mT_per_krpm", "mT/krpm", "of the current drawn at 1000 rpm", sought=False)

MOTOR_FIELD = Effect(
    name="motor_field",
    stage="magnet",
    acts_on="channels",
    params={
        **_BY_CURRENT,
        **_BY_SPEED,
        "field_mT": OWN_FIELD,
    },
    vectors=(tuple(_BY_CURRENT),),
    forward=forward,
    at_magnet=at_magnet,
    assumes=f"a field of {FIELD_MT:g} mT at the sensor",
    # Without a reference the speed is told by these very readings, and a motor that coasts draws no current.
    # Which way the shaft turns decides which way its drag pulls, and the current with it.
    needs=frozenset(
        {
            "two currents|a reference",
            "two currents|moving shaft",
            "two currents|two speeds|both directions",
        }
    ),
    source="Biot and Savart: the field of a winding and its leads in proportion to the current, added to the magnet's; "
    "a motor's current in proportion to the torque of drag",
    signature="order 1 times the current, or times the speed",
)
