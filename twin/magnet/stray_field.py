"""stray_field: a uniform field fixed in the stator, relative to the magnet's field at the sensor."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.hall.offset import add
from twin.motion import Motion

FIELD_MT = 50.0
"""The magnet's field at the sensor that the millitesla are counted against where no magnet is described."""


OWN_FIELD = Param(
    unit="mT",
    null=FIELD_MT,
    lower=1.0,
    upper=500.0,
    doc="the magnet's own field",
    role="shape",
    typical=10.0,
    field_power=1.0,
)


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    scale = 1.0 / values.get("field_mT", FIELD_MT)
    return add(signal, *along_axes(values["bx_mT"] * scale, values["by_mT"] * scale, motion))


def along_axes(bx: Array | float, by: Array | float, motion: Motion) -> tuple[Array | float, Array | float]:
    """A field fixed in the stator along the sensor's axes, given along those of the first recording."""
    if motion.recordings is None:
        return bx, by
    # A sensor that was turned sees a field that stays turn back.
    c, s = np.cos(motion.recordings.turned_rad), np.sin(motion.recordings.turned_rad)
    return c * bx + s * by, c * by - s * bx


def beside(effect: Effect, assembly: Any) -> Effect:
    """An effect beside a described magnet (an ``Assembly``): its millitesla count against that magnet's field."""
    own = replace(OWN_FIELD, null=float(np.clip(assembly.nominal_mT, OWN_FIELD.lower, OWN_FIELD.upper)))
    return replace(effect, params={**effect.params, "field_mT": own}, assumes="")


def at_magnet(assembly: Any) -> Effect:
    """The effect beside a described magnet."""
    return beside(STRAY_FIELD, assembly)


STRAY_FIELD = Effect(
    name="stray_field",
    stage="magnet",
    acts_on="channels",
    params={
        "bx_mT": Param(
            unit="mT", null=0.0, lower=-50.0, upper=50.0, doc="stray field along the sensor's x", owner="bench"
        ),
        "by_mT": Param(
            unit="mT",
            null=0.0,
            lower=-50.0,
            upper=50.0,
            doc="stray field along the sensor's y",
            mirror=-1,
            owner="bench",
        ),
        "field_mT": OWN_FIELD,
    },
    forward=forward,
    at_magnet=at_magnet,
    assumes=f"a field of {FIELD_MT:g} mT at the sensor",
    needs=frozenset({"two mountings"}),
    source="superposition of fields; a constant added to both channels ahead of the gains",
    signature="order 1: the same as offset",
)
