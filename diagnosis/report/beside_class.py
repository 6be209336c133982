"""Intervals of parameters over what the causes may hide: with an effect beside them that one of them does most of."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from diagnosis.discovery.fitting.free_parameters import value_of
from diagnosis.discovery.fitting.intervals import intervals_95, quantile_95, with_open_torques
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.result import Discovery
from twin.catalogue import find
from twin.confidence import mixed_95

Intervals = Mapping[tuple[str, str], tuple[float, float]]
_NOTICED = 1.01
"""An interval that is wider by less is told as it is: its half width is given to two digits."""


def beside_each(known: Intervals, found: Discovery) -> dict[str, Intervals]:
    """These 95 % intervals of the fit's parameters as they are if an effect may be beside the causes, by its name.

    The fit with it and the one without are each as likely as the readings leave them.
    """
    return {one[0]: _mixed(known, found.fit, one) for one in found.fits_beside}


@lru_cache(maxsize=4)
def over_all_beside(found: Discovery) -> Intervals:
    """95 % intervals of the fit's parameters, wide enough for each of them and for torques that are not told."""
    known = with_open_torques(found.fit, intervals_95(found.fit))
    wider = dict(known)
    for each in beside_each(known, found).values():
        for key, (low, high) in each.items():
            wider[key] = min(wider[key][0], low), max(wider[key][1], high)
    return wider


def _mixed(known: Intervals, fit: Fit, beside: tuple[str, Fit, float]) -> Intervals:
    """The same with one effect: mixtures of the figures without it and with it, where that widens them at all."""
    name, with_it, odds = beside
    mixed = dict(known)
    for place, free in enumerate(with_it.free):
        key = (free.key, free.name)
        if free.turn is not None or key not in known:
            continue
        own, other = (value_of(one.chain, free) for one in (fit, with_it))
        low, high = _ends(with_it, place, name)
        param = find(free.key, fit.chain.effects).params[free.name]
        if param.role == "phase":
            # It may have gone round on the way from one fit to the other.
            turned = 360.0 * round((own - other) / 360.0)
            other, low, high = other + turned, low + turned, high + turned
        else:
            low, high = max(low, param.lower), min(high, param.upper)
        before = known[key]
        ends = mixed_95([(1.0, own, *before), (odds, other, low, high)])
        if ends[1] - ends[0] > _NOTICED * (before[1] - before[0]):
            mixed[key] = ends
    return mixed


def _ends(beside: Fit, place: int, name: str) -> tuple[float, float]:
    """95 % interval of the parameter at a place, the effect of this name being no weaker than it can be.

    The parameter follows the effect's strength on a straight line, as far as that goes either way, and scatters about
    the line.
    """
    (strength,) = (number for number, one in enumerate(beside.free) if one.key == name)
    free = beside.free[strength]
    covariance, reach = beside.covariance(), quantile_95(beside)
    deviation = float(np.sqrt(covariance[strength, strength]))
    slope = float(covariance[place, strength]) / deviation**2
    about = float(np.sqrt(max(covariance[place, place] - slope**2 * deviation**2, 0.0)))
    param, at = find(name, beside.chain.effects).params[free.name], value_of(beside.chain, free)
    weaker, stronger = (min(reach * deviation, room) for room in (at - param.lower, param.upper - at))
    down, up = (weaker, stronger) if slope >= 0.0 else (stronger, weaker)
    value = value_of(beside.chain, beside.free[place])
    low, high = (float(np.hypot(slope * one, reach * about)) for one in (down, up))
    return value - low, value + high
