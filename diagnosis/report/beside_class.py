"""Intervals of parameters over what the causes may hide: with an effect beside them that one of them does most of."""

from __future__ import annotations

from collections.abc import Mapping

from diagnosis.discovery.fitting.free_parameters import Free, value_of
from diagnosis.discovery.fitting.intervals import parabola_95
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.result import Discovery
from twin.catalogue import find
from twin.confidence import mixed_95

Intervals = Mapping[tuple[str, str], tuple[float, float]]


def beside_each(known: Intervals, found: Discovery) -> dict[str, Intervals]:
    """These 95 % intervals of the fit's parameters as they are if an effect may be beside the causes, by its name.

    The fit with it and the one without are each as likely as the readings leave them.
    """
    return {name: _mixed(known, found.fit, fit, odds) for name, fit, odds in found.fits_beside}


def over_all_beside(known: Intervals, found: Discovery) -> Intervals:
    """The same, wide enough for any of them."""
    wider = dict(known)
    for each in beside_each(known, found).values():
        for key, (low, high) in each.items():
            wider[key] = min(wider[key][0], low), max(wider[key][1], high)
    return wider


def _mixed(known: Intervals, fit: Fit, beside: Fit, odds: float) -> Intervals:
    mixed = dict(known)
    for (key, name), ends in parabola_95(beside).items():
        if (key, name) not in known:
            continue
        own, other = (value_of(one.chain, Free(key, name)) for one in (fit, beside))
        param = find(key, fit.chain.effects).params[name]
        if param.role == "phase":
            # It may have gone round on the way from one fit to the other.
            turned = 360.0 * round((own - other) / 360.0)
            other, low, high = other + turned, ends[0] + turned, ends[1] + turned
        else:
            low, high = max(ends[0], param.lower), min(ends[1], param.upper)
        mixed[key, name] = mixed_95([(1.0, own, *known[key, name]), (odds, other, low, high)])
    return mixed
