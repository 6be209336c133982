"""magnet_harmonic: higher azimuthal orders of the magnetisation turn the field unevenly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from twin.angles import Array, radians
from twin.drawing import whole
from twin.effect import Comb, Effect, Param, Parameters
from twin.found_by import order_of
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    turn = radians(values["amplitude_deg"])
    return signal + turn * np.sin(np.asarray(values["order"]) * signal + radians(values["phase_deg"]))


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    return [{"order": float(order)} for order in range(3, 9) if 2 * order < motion.points_per_turn]


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
    },
    forward=forward,
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
    signature="one line at order n, 3 to 8, any phase",
)
