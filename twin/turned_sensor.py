"""A twin whose sensor has been turned about the shaft: the same device, which sees the magnet from another side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from twin.angles import wrap_deg
from twin.chain import Chain
from twin.limits import require_within
from twin.mechanics.zero import ZERO
from twin.motion import Motion
from twin.recordings import Recordings, Setup

LARGEST_TURN_DEG = 360.0


def with_sensor_turned(chain: Chain, motion: Motion, turned_deg: float) -> tuple[Chain, Motion]:
    """The same device on the same motion, with its sensor turned about the shaft, with the angles that it counts.

    Where the sensor sits, its tilt and all errors of its channels turn with it; reference, coupling, a stray field
    and the motor stay where they are.

    Parameters
    ----------
    chain : Chain
        The twin.
    motion : Motion
        What the shaft does, in one recording.
    turned_deg : float
        By how much the sensor is turned [deg], from -360 to 360.

    Returns
    -------
    tuple of Chain and Motion
        The chain whose zero stands back by as much, and the motion that knows of the turn.

    Raises
    ------
    OutOfRangeError
        For another turn.
    """
    require_within("mounting", turned_deg, -LARGEST_TURN_DEG, LARGEST_TURN_DEG, "deg")
    zero_deg = float(chain.values.get(ZERO.name, {}).get("zero_deg", ZERO.params["zero_deg"].null))
    turned = chain.with_effect(ZERO.name, zero_deg=float(wrap_deg(zero_deg - turned_deg)))
    if chain.magnet is not None:
        place = chain.magnet.placement
        back = (place.stray_x_mT + 1j * place.stray_y_mT) * np.exp(-1j * np.radians(turned_deg))
        there = replace(place, stray_x_mT=float(back.real), stray_y_mT=float(back.imag))
        turned = turned.with_magnet(replace(chain.magnet, placement=there))
    setup = Setup(turned_deg=turned_deg)
    return turned, replace(motion, recordings=Recordings(np.zeros(len(motion), dtype=np.int64), (setup,)))
