"""Torque ripple: how far a shaft is turned by a torque that is locked to its angle.

A torque of order k that gives the rotor the angular acceleration a cos(k theta) turns it by -a cos(k theta)/(k w)^2 at
the speed w: against 1/speed^2 an error of the sensor, which stays, is told from it.
"""

from __future__ import annotations

import numpy as np

from twin.angles import TAU, Array
from twin.second_inertia import Behind

_GRID = 4096
"""Angles of a turn: of the orders up to 64, 64 a period."""


def response(
    order: float,
    *,
    shaft_rad: Array,
    speed_rad_s: Array,
    acceleration_rad_s2: Array,
    damping_per_s: float = 0.0,
    behind: Behind | None = None,
) -> Array:
    """Angles (2, n) [rad] by which accelerations cos(k theta) and sin(k theta) of 1 rad/s^2 turn a moving shaft.

    With h e^(ik theta) for the angle, h'' + (2ikw + g) h' + (ikw' - k^2 w^2 + ikwg) h = 1, where g is the damping, by
    which friction and a drive that holds the speed slow a departure from it. Undamped and evenly accelerated, h is
    -1/(kw)^2 times 1 - 3x + 15x^2 - 105x^3 + ... with x = i w'/(k w^2), a series that converges nowhere. Its diagonal
    Pade approximant of order 2 is taken (G. A. Baker, P. Graves-Morris, Pade Approximants (1996), on Stieltjes series):
    off by 0.002 where the speed changes by a tenth in a radian. ``speed_rad_s`` must nowhere be zero. ``behind``: the
    rotor is not of one piece; accelerations are those of both inertias together.
    """
    turning = order * speed_rad_s
    x = 1j * order * acceleration_rad_s2 / turning**2
    even = (1.0 + 11.0 * x + 8.0 * x**2) / (1.0 + 14.0 * x + 35.0 * x**2)
    size = np.asarray(even / (1j * turning * (1j * turning + damping_per_s)), dtype=np.complex128)
    if behind is None:
        wave = size * np.exp(1j * order * shaft_rad)
    else:
        wave = behind.carried(size, order, shaft_rad=shaft_rad, speed_rad_s=speed_rad_s)
    return np.stack([wave.real, wave.imag])


def second_order(torques_rad_s2: Array, *, shaft_rad: Array, speed_rad_s: Array) -> Array:
    """Angle (n,) [rad] by which torques turn a shaft beyond :func:`response`, their squares and products.

    By the energy: v^2 = w^2 + 2 G with G the integral of the torques over the angle, so that the shaft is ahead by
    the integral over the angle of 1 - w/v = G/w^2 - (3/2) (G^2 - <G^2>)/w^4 + ...; the first term is the response.
    A torque of order k that turns the shaft by h makes (3/8) k h^2 of the order 2k, which falls as 1/speed^4.

    Parameters
    ----------
    torques_rad_s2 : ndarray
        Accelerations (orders, 2) that go with cosine and sine of each order from 1 on [rad/s^2].
    shaft_rad, speed_rad_s : ndarray
        Angle [rad] and speed [rad/s] at each reading (n,).
    """
    order = np.arange(1, len(torques_rad_s2) + 1)
    waves = np.zeros(_GRID // 2 + 1, dtype=np.complex128)
    waves[order] = 0.5 * _GRID * (torques_rad_s2[:, 0] - 1j * torques_rad_s2[:, 1]) / (1j * order)
    squares = np.fft.rfft(np.fft.irfft(waves) ** 2)
    squares[0] = 0.0
    turning = 1j * np.arange(1, squares.size)
    ahead = np.fft.irfft(np.concatenate([[0.0], -1.5 * squares[1:] / turning]))
    turn = TAU / _GRID * np.arange(_GRID)
    return np.asarray(np.interp(shaft_rad, turn, ahead, period=TAU) / speed_rad_s**4)
