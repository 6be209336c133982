"""drive_ripple: the shaft departs from the angle that the drive reports (ripple, wind-up) at the motor's order."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import Array, radians
from twin.drawing import whole
from twin.effect import BoolArray, Comb, Effect, Line, Param, Parameters
from twin.found_by import order_of
from twin.motion import Motion

LOWEST_ORDER = 20


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    # The ripple follows the angle that the drive is commanded to, which is what it hands on as the reference.
    ripple = np.sin(np.asarray(values["order"]) * motion.shaft_rad + radians(values["phase_deg"]))
    return signal + radians(values["amplitude_deg"]) * ripple


def limits(motion: Motion) -> tuple[float, float]:
    return LOWEST_ORDER, motion.points_per_turn / 2.0


def within(order: Array) -> BoolArray:
    """Which orders (any shape) a motor sets: whole numbers from 20 upwards."""
    return np.asarray((order >= LOWEST_ORDER) & (np.abs(order - np.round(order)) < 1e-9))


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """Any order that the readings resolve."""
    return {"order": whole(uniform[:, 2], LOWEST_ORDER, max(LOWEST_ORDER, int(motion.points_per_turn) // 2 - 1))}


DRIVE_RIPPLE = Effect(
    name="drive_ripple",
    stage="reference",
    acts_on="shaft",
    params={
        "order": Param(
            unit="1/turn",
            null=50,
            lower=20,
            upper=1e5,
            doc="50 for a 200-step stepper",
            role="shape",
            counts=True,
        ),
        "amplitude_deg": Param(unit="deg", null=0.0, lower=0.0, upper=10.0, doc="amplitude"),
        "phase_deg": Param(unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="phase", role="phase"),
    },
    forward=forward,
    line=Line(param="order", clock="shaft", limits=limits, within=within, multiples=(2, 3, 4, 5)),
    comb=Comb(
        orders=order_of,
        also=(
            "mechanics",
            "from mechanics (teeth of a belt or gear): count them, or turn the shaft by another drive",
        ),
    ),
    repeatable=True,
    drawing=drawing,
    needs=frozenset({"a reference", "one turn"}),
    source="a 2-phase stepper of 200 steps has 50 electrical periods a turn; a BLDC motor 6 x pole pairs torque ripple",
    signature="lines at p >= 20 and its multiples",
)
