"""How much the coefficients beside a motion scatter, and which of them the readings tell."""

from __future__ import annotations

import numpy as np

from diagnosis.spin.columns import (
    HIGHEST_OF_FRICTION,
    HIGHEST_ORDER,
    OF_ERROR,
    OF_FRICTION,
    OF_LATE,
)
from diagnosis.spin.problem import Reduced
from diagnosis.spin.variance_components import Drawn, drawn, solved
from twin.angles import Array
from twin.effect import BoolArray
from twin.pace import two_speeds_alone

ANY_GROWTH = np.full(HIGHEST_OF_FRICTION, np.inf)
_OF_RUN_OUT = 2
"""Orders of a part that runs out or is bent: what it rubs has harmonics, none of them stronger."""
_TOLD = 0.5
"""Share of a coefficient that the readings tell, from which on its scatter is told by them too."""


def amplitudes_seen(reduced: Reduced, variance: float) -> Array:
    """Amplitude [rad] of each order (orders,): without any torque, all of it is the sensor's."""
    own = slice(OF_ERROR)
    seen = np.linalg.solve(reduced.normal[own, own] + 1e-12 * np.eye(OF_ERROR), reduced.gradient[own])
    noise = variance / np.diag(reduced.normal)[own]
    return np.asarray(np.sqrt(np.sum((seen**2 + noise).reshape(-1, 2), axis=1)))


def separable_orders(reduced: Reduced, variance: float, usual_rad_s: float, largest_rad_s2: Array) -> BoolArray:
    """Whether of each order (orders,) a torque that makes all that is seen of it would be told from an error."""
    if len(reduced.gradient) <= OF_ERROR:
        return np.zeros(HIGHEST_ORDER, dtype=bool)
    orders = np.arange(1, HIGHEST_ORDER + 1)
    makes = np.maximum(amplitudes_seen(reduced, variance) * (orders * usual_rad_s) ** 2, largest_rad_s2)
    return _told(reduced, variance, np.repeat(makes, 2))[:HIGHEST_ORDER]


def _late_channel_told(reduced: Reduced, variance: float, usual_rad_s: float) -> bool:
    """Whether an error of order 2 that grows with the speed is told from torques, were either all that is seen."""
    orders = np.arange(1, HIGHEST_ORDER + 1)
    seen = amplitudes_seen(reduced, variance)
    makes = np.repeat(seen * (orders * usual_rad_s) ** 2, 2)
    late = np.full(2, seen[1] / usual_rad_s)
    rubs = makes[: 2 * HIGHEST_OF_FRICTION]
    told = _told(reduced, variance, np.concatenate([makes, rubs / usual_rad_s, 1e-9 * rubs, late]))
    return bool(told[1] and told[-1])


def _told(reduced: Reduced, variance: float, sd: Array) -> BoolArray:
    """Of which pairs beside the error of the sensor the readings tell most, were they to scatter so (2 pairs,)."""
    count = OF_ERROR + sd.size
    scatter = np.concatenate([np.full(OF_ERROR, np.inf), sd])
    told = solved(reduced.normal[:count, :count], reduced.gradient[:count], variance, scatter).told[OF_ERROR:]
    return np.asarray(np.mean(told.reshape(-1, 2), axis=1) > _TOLD)


def coefficients(
    reduced: Reduced,
    sd: Array,
    variance: float,
    speed_rad_s: Array,
    separable: BoolArray,
    *,
    most_growing: Array,
) -> tuple[Drawn, Array]:
    """The coefficients, each order's torque by a scatter of its own; none where it would not be told.

    A torque that grows with the speed, as a modulated viscous friction does, is told from a constant one by three
    speeds or more: at two alone it would be by how each of them wavers, which a drive that holds it answers to in its
    own way. Where it is not told, it is taken to be there, half as large in the mean square over the readings, but no
    larger than it is known to be at most, nor than those of the orders 1 and 2: a torque of a higher order is a
    cogging, which does not grow. One that reverses with the speed, as a modulated dry friction does, is told by a log
    that has both directions. An error of order 2 that grows with the speed, as of a channel that is read late, is told
    by three speeds; where it is not, none is taken to be there.
    """
    if len(sd) <= OF_ERROR:
        return solved(reduced.normal, reduced.gradient, variance, sd), ANY_GROWTH
    usual_rad_s = float(np.median(np.abs(speed_rad_s)))
    both_ways, third_speed = bool(np.ptp(np.sign(speed_rad_s)) > 0.0), not two_speeds_alone(speed_rad_s)
    pairs = [np.arange(place, place + 2) for place in range(OF_ERROR, OF_LATE, 2)]
    growing = pairs[HIGHEST_ORDER:][:HIGHEST_OF_FRICTION]
    reversing = pairs[HIGHEST_ORDER + HIGHEST_OF_FRICTION : -1] if both_ways else []
    groups = [pair for all_of in (pairs, reversing) for pair, told in zip(all_of, separable, strict=False) if told]
    sd = sd.copy()
    sd[OF_ERROR:OF_FRICTION] = 1e-9 * usual_rad_s
    sd[OF_FRICTION:OF_LATE] = 1e-9 / usual_rad_s
    sd[np.concatenate([np.zeros(0, dtype=np.int64), *groups])] = usual_rad_s**2
    if third_speed and _late_channel_told(reduced, variance, usual_rad_s):
        # Between two speeds it does what a torque of order 2 does, and would put another error in the sensor.
        sd[pairs[-1]] = 1.0 / usual_rad_s
        groups = [*groups, pairs[-1]]
    found = drawn(reduced.normal, reduced.gradient, variance, groups=groups, sd=sd)
    sd = found.sd.copy()
    half = 0.5 * sd[[pair[0] for pair in pairs[: len(growing)]]] / float(np.sqrt(np.mean(speed_rad_s**2)))
    if separable[:_OF_RUN_OUT].any():
        beyond = half[_OF_RUN_OUT:]
        half[_OF_RUN_OUT:] = np.clip(np.max(half[:_OF_RUN_OUT]), np.minimum(1e-9, beyond), beyond)
    for group, size in zip(growing, np.minimum(half, most_growing), strict=True):
        sd[group] = size
    found = drawn(reduced.normal, reduced.gradient, variance, groups=groups, sd=sd)
    told = np.array([third_speed and bool(np.mean(found.told[group]) > _TOLD) for group in growing])
    more = [group for group, is_told in zip(growing, told, strict=True) if is_told]
    if more:
        found = drawn(reduced.normal, reduced.gradient, variance, groups=[*groups, *more], sd=found.sd)
    return found, np.where(told, found.sd[[group[0] for group in growing]], np.inf)
