"""What stands beside the smooth motion in a reading: the sensor's error and torques, order by order of the angle."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.mechanics.torque_ripple import response
from twin.second_inertia import Behind, SecondInertia

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


@dataclass(frozen=True, eq=False)
class Path:
    """How a shaft moves (n,), in stretches one behind the other, and how fast a departure from its speed is undone."""

    shaft_rad: Array
    speed_rad_s: Array
    acceleration_rad_s2: Array
    time_s: Array
    stretches: Sequence[slice]
    damping_per_s: float

    def turned(self, orders: Iterable[int], second: SecondInertia | None) -> Array:
        """What torques of these orders that give 1 rad/s^2 turn the shaft by (2 orders, n) [rad]."""
        behind = None if second is None else Behind(second, self.time_s, self.stretches)
        return np.concatenate(
            [
                response(
                    order,
                    shaft_rad=self.shaft_rad,
                    speed_rad_s=self.speed_rad_s,
                    acceleration_rad_s2=self.acceleration_rad_s2,
                    damping_per_s=self.damping_per_s,
                    behind=behind,
                )
                for order in orders
            ]
        )


def torques(path: Path, second: SecondInertia | None) -> Array:
    """What torques of each order that give 1 rad/s^2, or modulate drag, add to the angle: (.., n) [rad].

    And an error of order 2 that is as large as the speed.
    """
    all_of, speed = path.turned(ORDERS, second), path.speed_rad_s
    late = speed * np.stack([np.cos(2.0 * path.shaft_rad), np.sin(2.0 * path.shaft_rad)])
    rubs = all_of[: 2 * HIGHEST_OF_FRICTION]
    return np.concatenate([all_of, speed * rubs, np.sign(speed) * rubs, late])
