"""motor_field: a stray field of the motor, fixed in the stator, that grows with the motor's current."""

from __future__ import annotations

from typing import Any

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.hall.offset import add
from twin.magnet.stray_field import FIELD_MT, OWN_FIELD, along_axes, beside
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    share = motion.current_a / np.asarray(values.get("field_mT", FIELD_MT))
    bx, by = np.asarray(values["bx_mT_per_A"]) * share, np.asarray(values["by_mT_per_A"]) * share
    return add(signal, *along_axes(bx, by, motion))


def at_magnet(assembly: Any) -> Effect:
    """The effect beside a described magnet."""
    return beside(MOTOR_FIELD, assembly)


MOTOR_FIELD = Effect(
    name="motor_field",
    stage="magnet",
    acts_on="channels",
    params={
        "bx_mT_per_A": Param(
            unit="mT/A", null=0.0, lower=-50.0, upper=50.0, doc="field of an ampere along the sensor's x", owner="bench"
        ),
        "by_mT_per_A": Param(
            unit="mT/A",
            null=0.0,
            lower=-50.0,
            upper=50.0,
            doc="field of an ampere along the sensor's y",
            mirror=-1,
            owner="bench",
        ),
        "field_mT": OWN_FIELD,
    },
    forward=forward,
    at_magnet=at_magnet,
    assumes=f"a field of {FIELD_MT:g} mT at the sensor",
    needs=frozenset({"two currents"}),
    source="Biot and Savart: the field of a winding and its leads in proportion to the current, added to the magnet's",
    signature="order 1 times the current",
)
