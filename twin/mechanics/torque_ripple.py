"""Torque ripple: how far a shaft is turned by a torque that is locked to its angle.

A torque of order k that gives the rotor the angular acceleration a cos(k theta) turns it by -a cos(k theta)/(k w)^2 at
the speed w: against 1/speed^2 an error of the sensor, which stays, is told from it.
"""

from __future__ import annotations

import numpy as np

from twin.angles import Array


def response(
    order: float, *, shaft_rad: Array, speed_rad_s: Array, acceleration_rad_s2: Array, damping_per_s: float = 0.0
) -> Array:
    """Angles (2, n) [rad] by which accelerations cos(k theta) and sin(k theta) of 1 rad/s^2 turn a moving shaft.

    The first two terms of the expansion in (rate of change of the speed)/(order speed^2): with h e^(ik theta) for the
    angle, h'' + (2ikw + g) h' + (ikw' - k^2 w^2 + ikwg) h = 1, where g is the damping, by which friction and a drive
    that holds the speed slow a departure from it. ``speed_rad_s`` must nowhere be zero.
    """
    turning = order * speed_rad_s
    size = (1.0 - 3.0j * order * acceleration_rad_s2 / turning**2) / (1j * turning * (1j * turning + damping_per_s))
    wave = size * np.exp(1j * order * shaft_rad)
    return np.stack([wave.real, wave.imag])
