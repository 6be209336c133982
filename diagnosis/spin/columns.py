"""What stands beside the smooth motion in a reading: the sensor's error and torques, order by order of the angle."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from twin.angles import Array
from twin.mechanics.torque_ripple import response
from twin.second_inertia import Behind

HIGHEST_ORDER = 32
"""Of the sensor's error and of the torques: the second harmonic of a cogging by sixteen teeth."""
HIGHEST_OF_FRICTION = 4
"""Of what friction makes: what rubs is modulated by what runs out or is bent, not by teeth."""
ORDERS = range(1, HIGHEST_ORDER + 1)
OF_ERROR, OF_TORQUE = 2 * HIGHEST_ORDER, 4 * HIGHEST_ORDER
OF_GROWING = OF_TORQUE + 2 * HIGHEST_OF_FRICTION
OF_FRICTION = OF_GROWING + 2 * HIGHEST_OF_FRICTION
OF_LATE = OF_FRICTION + 2
"""Where the coefficients of the error, of torques alike at any speed, of those that grow and of those that reverse with
it, and of a late channel end; by how much damping and second inertia are other than they are taken to be follows."""


def waves(shaft_rad: Array) -> Array:
    """Cosine and sine (2 orders, n) of each order of the angle."""
    return np.concatenate([np.stack([np.cos(k * shaft_rad), np.sin(k * shaft_rad)]) for k in ORDERS])


def moved(
    orders: Iterable[int],
    *,
    shaft_rad: Array,
    speed_rad_s: Array,
    acceleration_rad_s2: Array,
    damping_per_s: float,
    behind: Behind | None,
) -> Array:
    """What torques of these orders that give 1 rad/s^2 turn the shaft by (2 orders, n) [rad]."""
    motion = {"shaft_rad": shaft_rad, "speed_rad_s": speed_rad_s, "acceleration_rad_s2": acceleration_rad_s2}
    return np.concatenate([response(k, **motion, damping_per_s=damping_per_s, behind=behind) for k in orders])


def torques(
    shaft_rad: Array,
    speed_rad_s: Array,
    acceleration_rad_s2: Array,
    *,
    damping_per_s: float,
    behind: Behind | None,
) -> Array:
    """What torques of each order that give 1 rad/s^2, or modulate drag, add to the angle: (.., n) [rad].

    And an error of order 2 that is as large as the speed.
    """
    all_of = moved(
        ORDERS,
        shaft_rad=shaft_rad,
        speed_rad_s=speed_rad_s,
        acceleration_rad_s2=acceleration_rad_s2,
        damping_per_s=damping_per_s,
        behind=behind,
    )
    late = speed_rad_s * np.stack([np.cos(2.0 * shaft_rad), np.sin(2.0 * shaft_rad)])
    rubs = all_of[: 2 * HIGHEST_OF_FRICTION]
    return np.concatenate([all_of, speed_rad_s * rubs, np.sign(speed_rad_s) * rubs, late])
