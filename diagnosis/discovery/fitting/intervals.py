"""How well a fit knows its parameters: standard deviations, and the quantile that makes 95 % intervals of them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from diagnosis.discovery.fitting.free_parameters import Free, value_of
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, root_weights
from diagnosis.discovery.fitting.open_torques import shifts
from diagnosis.discovery.fitting.profile import Profile
from diagnosis.discovery.fitting.projection import projected
from twin.catalogue import find
from twin.confidence import student_95

Deviations = dict[tuple[str, str], float]
"""Standard deviation of a parameter, by effect and parameter."""
_JOINT_95 = 0.95


def standard_deviations(fit: Fit) -> Deviations:
    """Standard deviation of every free scalar parameter of a fit, in its own unit."""
    variance = np.diag(fit.covariance()) if fit.free else np.zeros(0)
    return {
        (free.key, free.name): float(np.sqrt(max(v, 0.0)))
        for free, v in zip(fit.free, variance, strict=True)
        if free.turn is None
    }


def quantile_95(fit: Fit) -> float:
    """Half width of a 95 % interval in standard deviations: Student's t, as the noise is known from what is left."""
    return student_95(max(fit.rows - len(fit.free), 1))


def interval_of_derived(fit: Fit, key: str, name: str) -> tuple[float, float]:
    """Low and high of a figure above zero that follows from an effect's parameters.

    The delta method on its logarithm: its 95 % interval has no end below zero.
    """
    effect = find(key, fit.chain.effects)
    values = {**effect.null(), **fit.chain.values[key]}
    places = [place for place, one in enumerate(fit.free) if one.key == key and one.turn is None]
    value = effect.derived(values)[name][0]
    if value <= 0.0 or not places:
        return value, value
    by_torques = shifts(fit)
    covariance = (fit.covariance() + by_torques @ by_torques.T)[np.ix_(places, places)]

    def log_at(parameter: str, by: float) -> float:
        moved = effect.derived({**values, parameter: float(values[parameter]) + by})[name][0]
        return float(np.log(max(moved, 1e-300)))

    steps = 1e-4 * np.sqrt(np.diag(covariance))
    names = [fit.free[place].name for place in places]
    slope = [
        (log_at(one, step) - log_at(one, -step)) / (2.0 * step) if 0.0 < step < np.inf else 0.0
        for one, step in zip(names, steps, strict=True)
    ]
    known = np.where(np.isfinite(covariance), covariance, 0.0)
    factor = float(np.exp(quantile_95(fit) * np.sqrt(max(float(slope @ known @ slope), 0.0))))
    return value / factor, value * factor


def parabola_95(fit: Fit) -> dict[tuple[str, str], tuple[float, float]]:
    """95 % interval of every free scalar parameter of a fit, in its own unit, by its standard deviation alone."""
    reach = quantile_95(fit)
    found = {}
    for (key, name), one in standard_deviations(fit).items():
        value = value_of(fit.chain, Free(key, name))
        found[key, name] = (value - reach * one, value + reach * one)
    return found


@lru_cache(maxsize=4)
def intervals_95(fit: Fit) -> Mapping[tuple[str, str], tuple[float, float]]:
    """95 % interval of every free scalar parameter of a fit, in its own unit; infinite where nothing is known of it.

    By the profile likelihood, which within an interval is mostly a parabola. Of stairs in the channels it is none at
    all: what scatters at their edges is in the standard deviation alone. So it is of stairs behind an estimated motion,
    whose edges tell of the shaft as well.
    """
    found = parabola_95(fit)
    if fit.free and not (fit.weighting.slopes or fit.by_average):
        # What a prior holds is as uncertain as that says, by whichever likelihood.
        deviation = standard_deviations(fit)
        known = [
            place
            for place, one in enumerate(fit.free)
            if 0.0 < deviation.get((one.key, one.name), 0.0) < np.inf and fit.strengths[place] == 0.0
        ]
        ends = Profile(fit, fit.covariance(), quantile_95(fit)).intervals(known)
        found |= {(fit.free[place].key, fit.free[place].name): both for place, both in ends.items()}
    return found


def with_open_torques(
    fit: Fit, known: Mapping[tuple[str, str], tuple[float, float]]
) -> dict[tuple[str, str], tuple[float, float]]:
    """These 95 % intervals, wider by what torques may have done that the log's speeds do not tell from the sensor.

    The same intervals where a reference was recorded.
    """
    found = dict(known)
    away = quantile_95(fit) * np.linalg.norm(shifts(fit), axis=1)
    for free, by_torques in zip(fit.free, away, strict=True):
        if (free.key, free.name) not in found or by_torques == 0.0:
            continue
        param, value = find(free.key, fit.chain.effects).params[free.name], value_of(fit.chain, free)
        low, high = found[free.key, free.name]
        low, high = value - float(np.hypot(value - low, by_torques)), value + float(np.hypot(high - value, by_torques))
        found[free.key, free.name] = (max(low, param.lower), min(high, param.upper))
    return found


def may_be_null(fit: Fit, key: str) -> bool:
    """Whether nothing may be there: whether the joint 95 % region of a cause's strengths and phases holds their null.

    Strengths and phases are asked together: an amplitude alone, its phase free to turn, may be as uncertain as it is
    large while something is there beyond doubt. Of a zero for each turn the spread is asked. What has no strength that
    a fit moves, such as a whole number of bits, is not asked.
    """
    effect, values = find(key, fit.chain.effects), fit.chain.values.get(key, {})
    free = {one.name for one in fit.free if one.key == key and one.turn is None}
    # A detail that acts by itself may be all that there is of it; any other is in what the strengths do.
    strengths = [name for name in effect.acts_by if name in free]
    if strengths:
        away = {name: float(values[name]) - effect.params[name].null for name in strengths}
        phases = [name for name in effect.roles("phase") if name in free]
        return _within_joint_region(fit, key, away, len(strengths) + len(phases))
    told = effect.derived(values) if effect.roles("per turn") else {}
    spreads = [low for name, (_, low, _, _) in told.items() if name in effect.params]
    return bool(spreads) and not any(low > 0.0 for low in spreads)


def _within_joint_region(fit: Fit, key: str, away: Mapping[str, float], terms: int) -> bool:
    """Whether what a cause's strengths do, beside all other causes, is no more than its 95 % region holds (F test).

    ``away`` are the strengths from their null, ``terms`` they and their phases. The cause's own shapes are not among
    what it stands beside: without it they mean nothing.
    """
    from scipy.special import fdtri

    _, jacobian = fit.whitened()
    does = np.zeros(jacobian.shape[1])
    others = np.array([one.key != key for one in fit.free])
    if find(key, fit.chain.effects).whole:
        # Where channels are cut off to a square wave, a slope at the limit tells nothing of an uncut sensor.
        rest = tuple(one for one in fit.free if one.key != key)
        without = evaluate(fit.chain.without(key), rest, fit.observations, fit.weighting)
        change = without.cosine_residual - fit.cosine_residual
        does[: change.size] = (change * root_weights(fit.weighting, fit.observations.observables)).ravel()
    else:
        for column, one in zip(jacobian, fit.free, strict=True):
            if one.key == key and one.name in away:
                does = does + away[one.name] * column
    alone = projected(does, jacobian[others])
    return float(alone @ alone) <= terms * float(fdtri(terms, fit.freedom, _JOINT_95)) * fit.variance
