"""bearing_wobble: motion at the bearing's cage order, not periodic in one turn."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import Array, radians
from twin.drawing import span
from twin.effect import BoolArray, Effect, Line, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    turn = radians(values["amplitude_deg"])
    return signal + turn * np.sin(np.asarray(values["order"]) * signal + radians(values["phase_deg"]))


def within(order: Array) -> BoolArray:
    """Which orders (any shape) a cage can have."""
    return np.asarray((order >= 0.3) & (order <= 0.5))


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """Any cage's order."""
    return {"order": span(uniform[:, 2], 0.3, 0.5)}


BEARING_WOBBLE = Effect(
    name="bearing_wobble",
    stage="mechanics",
    acts_on="shaft",
    params={
        "order": Param(unit="1/turn", null=0.4, lower=0.3, upper=0.5, doc="cage cycles per turn", role="shape"),
        "amplitude_deg": Param(unit="deg", null=0.0, lower=0.0, upper=5.0, doc="amplitude"),
        "phase_deg": Param(unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="phase", role="phase"),
    },
    forward=forward,
    needs=frozenset({"several turns"}),
    line=Line(param="order", clock="shaft", limits=lambda motion: (0.3, 0.5), within=within),
    drawing=drawing,
    source="cage frequency of a rolling bearing, (1 - d cos(contact)/D)/2 cycles per turn: Harris, Rolling Bearing "
    "Analysis, chapter 25",
    signature="a line at a non-integer order between 0.3 and 0.5",
)
