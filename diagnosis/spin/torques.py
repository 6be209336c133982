"""What torques locked to the angle may have done to an estimated motion, taken out of what a fit is judged by."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from diagnosis.spin.columns import Path
from diagnosis.spin.spline import rate
from twin.angles import Array
from twin.effect import BoolArray
from twin.motion import Motion
from twin.noise.spectrum import to_cosine, to_rows
from twin.second_inertia import SecondInertia

RATE = 1e-3
"""Damping [1/s] by which the derivative of a response is taken."""


@lru_cache(maxsize=4)
def torque_columns(motion: Motion) -> Array:
    """Angles (m, n) [rad] by which torques may turn the shaft, each one standard deviation of what they may be.

    None (0, n) where a reference was recorded, or no torque is taken to be there.
    """
    found = motion.estimated
    if found is None:
        return np.zeros((0, len(motion)))
    columns, speed = [np.zeros((0, len(motion)))], _rates(motion)[0]
    for torque in found.torques:
        if torque.scatter_rad_s2 or torque.growing_rad_s or torque.reversing_rad_s2:
            moved = _moved(motion, torque.order)
            rubs = torque.growing_rad_s * speed, torque.reversing_rad_s2 * np.sign(speed)
            columns += [torque.scatter_rad_s2 * moved, *(each * moved for each in rubs)]
    # What was found of the torques turns the shaft as damped as it is, which is known so well.
    damped = (found_torques(motion, more_damped_per_s=RATE) - found_torques(motion)) / RATE
    columns.append(found.damping_sd_per_s * damped[None])
    if found.second is not None:
        usual = found_torques(motion)
        for other, part in found.second.scattered():
            columns.append(part * (found_torques(motion, second=other) - usual)[None])
    return np.concatenate(columns)


@lru_cache(maxsize=8)
def found_torques(motion: Motion, *, more_damped_per_s: float = 0.0, second: SecondInertia | None = None) -> Array:
    """Angle (n,) [rad] by which the torques that were found turn the shaft, to first order.

    It is part of an estimated motion. What they may be scatters about none, and not about what was found: readings that
    told it would count twice. ``second``: behind another inertia than the one that was found.
    """
    turned = np.zeros(len(motion))
    for torque in () if motion.estimated is None else motion.estimated.torques:
        if torque.scatter_rad_s2:
            moved = _moved(motion, torque.order, more_damped_per_s=more_damped_per_s, second=second)
            turned += np.array([torque.cos_rad_s2, torque.sin_rad_s2]) @ moved
    return turned


def _moved(motion: Motion, order: int, *, more_damped_per_s: float = 0.0, second: SecondInertia | None = None) -> Array:
    """What torques of an order that give 1 rad/s^2, with its cosine and its sine, turn the shaft by (2, n) [rad]."""
    found = motion.estimated
    assert found is not None
    damping_per_s = found.damping_per_s + more_damped_per_s
    path = Path(motion.shaft_rad, *_rates(motion), motion.time_s, found.slices, damping_per_s)
    known = found.second.second if second is None and found.second is not None else second
    moved = path.turned((order,), known)
    return np.where(found.knee_rad > 0.0, moved, 0.0)


@lru_cache(maxsize=4)
def _rates(motion: Motion) -> tuple[Array, Array]:
    """Speed [rad/s] and acceleration [rad/s^2] (n,) where the motion is estimated.

    Beside it the speed is a usual one, as a recorded reference may have none.
    """
    found = motion.estimated
    assert found is not None
    own = found.knee_rad > 0.0
    speed = np.where(own, motion.speed_rad_s, float(np.median(motion.speed_rad_s[own])))
    return speed, rate(speed, motion.time_s, found.slices)


def as_large_as_seen(motion: Motion, off_rad: Array, usable: BoolArray) -> Array:
    """Angles (m, n) [rad] by which torques turn the shaft that make all that is seen of an order, cosine and sine.

    Of the orders that the speeds leave open, as far as no torque of them is in :func:`torque_columns`. ``off_rad`` (n,)
    is what readings are off the motion.
    """
    found = motion.estimated
    orders = [] if found is None else [one.order for one in found.torques if not (one.separable or one.scatter_rad_s2)]
    if found is None or not orders:
        return np.zeros((0, len(motion)))
    angle = motion.shaft_rad
    waves = [np.ones_like(angle), *(wave(order * angle) for order in orders for wave in (np.cos, np.sin))]
    seen = np.linalg.lstsq(np.stack(waves).T[usable], off_rad[usable], rcond=None)[0][1:].reshape(-1, 2)
    usual, sizes = float(np.median(np.abs(_rates(motion)[0]))), np.linalg.norm(seen, axis=1)
    return np.concatenate(
        [size * (order * usual) ** 2 * _moved(motion, order) for order, size in zip(orders, sizes, strict=True)]
    )


_LEAST = 1e-4
"""Of what a direction does, against the noise of all readings: less than that moves no whitened reading by 1/20000."""


class Loose:
    """Directions in which readings are free by some standard deviation beside their noise and the motion, whitened.

    With columns T of one standard deviation each, beside noise and motion of covariance inv(W'W), readings have that of
    both. Its inverse square root is W (1 - T r f r' T' W'W) with shares f, where r makes W T r orthonormal: what is
    taken off has the shape of the columns, as far as the readings tell it beside the motion. Rows that are not in use
    lose what the others tell of the columns.

    Parameters
    ----------
    columns : ndarray
        What turns the shaft by one standard deviation (m, n) [rad].
    usable : ndarray
        Rows (n,) in use.
    noise : float
        RMS [rad] of a reading's noise.
    motion : ndarray or float
        Variance of the motion over that of the noise, for the cosine coefficients (n,) of each stretch.
    lengths : tuple of int
        Rows of each stretch; not given: all are one.
    """

    def __init__(
        self,
        columns: Array,
        usable: BoolArray,
        noise: float,
        motion: Array | float = 0.0,
        lengths: tuple[int, ...] | None = None,
    ) -> None:
        of = (usable.size,) if lengths is None else lengths
        used = columns * usable / noise
        weighed = to_rows(to_cosine(used, of) / (1.0 + motion), of) * usable
        size, turned = np.linalg.eigh(used @ weighed.T)
        told = size > _LEAST
        size, turned = size[told], turned[:, told]
        self._usable = usable
        self._along: Array = (turned / np.sqrt(size)).T @ weighed
        self._away: Array = ((turned * (1.0 - 1.0 / np.sqrt(1.0 + size))) / np.sqrt(size)).T @ used
        self._columns: Array = (turned * (np.sqrt(size) / (1.0 + size))).T @ (columns / noise)

    def whitened(self, values: Array) -> Array:
        """Values (..., n) less what they have along the directions."""
        along = (values * self._usable) @ self._along.T
        return np.asarray(values - np.where(self._usable, along @ self._away, along @ self._columns))

    def matched(self, values: Array) -> Array:
        """Whitened values (..., n), weighed by noise and motion, as columns are matched to that are not whitened."""
        return np.asarray(values - ((values * self._usable) @ self._away.T) @ self._along)
