"""magnet_harmonic: higher azimuthal orders of the magnetisation turn the field unevenly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from twin.angles import Array, radians
from twin.drawing import whole
from twin.effect import Behind, Comb, Effect, Param, Parameters
from twin.found_by import order_of
from twin.motion import Motion

RADIUS_RATIOS = 0.0, 1.0
"""The field's size on the axis, where a harmonic of the magnetisation has no field and bends that of the dipole alone;
and beside a cylinder, whose potential falls as a power of the distance. Where a potential rises, as inside a ring, it
is -1: what order 4 does then is what a saturating concentrator does."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    turn = radians(values["amplitude_deg"])
    return signal + turn * np.sin(np.asarray(values["order"]) * signal + radians(values["phase_deg"]))


def field_size(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    """The field is stronger where its direction turns one way and weaker a quarter of a period on."""
    turn = radians(values["amplitude_deg"]) * np.asarray(values["radius_ratio"])
    place = np.asarray(values["order"]) * motion.shaft_rad + radians(values["phase_deg"])
    return np.asarray(signal * (1.0 + turn * np.cos(place)))


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    ratios = RADIUS_RATIOS if "vx" in motion.provides else RADIUS_RATIOS[:1]
    orders = [order for order in range(3, 9) if 2 * order < motion.angles_in_a_turn]
    return [{"order": float(order), "radius_ratio": ratio} for ratio in ratios for order in orders]


def falls_off(values: Parameters) -> Any:
    """Power of the distance that the amplitude goes with.

    A harmonic of order n + 1 in the magnetisation turns the field by order n; its field falls with the distance from
    the magnet's centre n powers faster than the dipole's (multipole expansion), and so does the angle it turns by.
    """
    return -np.asarray(values["order"], dtype=np.float64)[()]


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """Any order."""
    return {"order": whole(uniform[:, 2], 3, 8)}


MAGNET_HARMONIC = Effect(
    name="magnet_harmonic",
    stage="magnet",
    acts_on="shaft",
    params={
        "order": Param(
            unit="1/turn",
            null=3,
            lower=3,
            upper=8,
            doc="azimuthal order",
            role="shape",
            counts=True,
            typical=1.0,
        ),
        "amplitude_deg": Param(
            unit="deg",
            null=0.0,
            lower=0.0,
            upper=20.0,
            doc="amplitude in the field angle",
            distance_power=falls_off,
        ),
        "phase_deg": Param(unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="phase", role="phase"),
        "radius_ratio": Param(
            unit="1",
            null=0.0,
            lower=0.0,
            upper=2.0,
            doc="relative change of the field's size over that of its direction; 1: beside a cylinder",
            role="shape",
            typical=0.5,
            aside=True,
            detail=True,
            told_by=frozenset({"vx"}),
        ),
    },
    forward=forward,
    behind=Behind(acts_on="channels", forward=field_size, params=("radius_ratio",)),
    needs=frozenset({"one turn"}),
    shapes=shapes,
    comb=Comb(
        orders=order_of,
        also=(
            "mechanics",
            "from mechanics (a pulley, gear or coupling): turn the magnet on its shaft: its own line follows",
        ),
        falling=True,
    ),
    repeatable=True,
    drawing=drawing,
    source="azimuthal Fourier series of the field of an imperfectly magnetised cylinder",
    signature="one line at order n, 3 to 8, any phase; in the radius none, or one of the same order and about as large",
)
