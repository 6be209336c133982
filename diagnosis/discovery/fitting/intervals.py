"""How well a fit knows its parameters: standard deviations, and the quantile that makes 95 % intervals of them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, root_weights, value_of
from diagnosis.discovery.fitting.noise.plausible import shares
from diagnosis.discovery.fitting.profile import Profile
from diagnosis.discovery.fitting.projection import projected
from twin.angles import Array
from twin.catalogue import find

Deviations = dict[tuple[str, str], float]
"""Standard deviation of a parameter, by effect and parameter."""
_TWO_SIDED_95 = 0.975
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
    from scipy.special import stdtrit

    freedom = max(fit.rows - len(fit.free), 1)
    return float(stdtrit(freedom, _TWO_SIDED_95))


@lru_cache(maxsize=4)
def noise_factors(fit: Fit) -> Array:
    """By how much each free parameter's deviation (P,) is larger as the noise's spectrum is one of several.

    A spectrum that is found from the residual is not known: at the low frequencies at which a sensor's orders lie a few
    coefficients tell it. By the law of total variance the noises' own variances are averaged by their probabilities,
    and what the estimates differ by from noise to noise is added (J. A. Hoeting et al., Bayesian Model Averaging,
    Statistical Science 14 (1999) 382).
    """
    one = np.ones(len(fit.free))
    if not fit.free or fit.weighting.slopes:
        return one
    share = shares(fit)
    if list(share) == [fit.weighting.member]:
        return one
    told = [_told_by(fit, member) for member in share]
    weights = np.array(list(share.values()))
    means = np.array([step for _, step in told])
    variance = weights @ [own for own, _ in told] + weights @ (means - weights @ means) ** 2
    now, _ = _told_by(fit, fit.weighting.member)
    ratio = np.divide(variance, now, out=one.copy(), where=now > 0.0)
    return np.asarray(np.sqrt(ratio))


def _told_by(fit: Fit, member: int) -> tuple[Array, Array]:
    """Variance of each free parameter (P,) with a noise of the family, and how far off its estimate is, to first order.

    Zero where nothing is told of it.
    """
    residual, columns = fit.whitened(member)
    size = np.linalg.norm(columns, axis=1)
    size[size == 0.0] = 1.0
    u, s, vt = np.linalg.svd(columns / size[:, None], full_matrices=False)
    good = s > 1e-9 * s[0]
    u, s, vt = u[:, good], s[good], vt[good]
    left = projected(residual, columns)
    freedom = max(fit.rows * fit.observations.observables - len(s), 1)
    variance = np.sum((u / s) ** 2, axis=1) * float(left @ left) / freedom
    return variance / size**2, (u / s) @ (vt @ residual) / size


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
    factors = noise_factors(fit)[places]
    covariance = fit.covariance()[np.ix_(places, places)] * np.outer(factors, factors)

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
    """95 % interval of every free scalar parameter of a fit, in its own unit, by its standard deviation alone.

    That includes what is not known of the noise's spectrum.
    """
    factors, deviations = dict(zip(fit.free, noise_factors(fit), strict=True)), standard_deviations(fit)
    found = {}
    for free, factor in factors.items():
        if free.turn is None:
            value, one = value_of(fit.chain, free), quantile_95(fit) * factor * deviations[free.key, free.name]
            found[free.key, free.name] = (value - one, value + one)
    return found


@lru_cache(maxsize=4)
def intervals_95(fit: Fit) -> Mapping[tuple[str, str], tuple[float, float]]:
    """95 % interval of every free scalar parameter of a fit, in its own unit; infinite where nothing is known of it.

    By the profile likelihood, which within an interval is mostly a parabola. Of stairs in the channels it is none at
    all: what scatters at their edges is in the standard deviation alone. What is not known of the noise's spectrum
    widens each side alike.
    """
    found = parabola_95(fit)
    if fit.free and not fit.weighting.slopes:
        # What a prior holds is as uncertain as that says, by whichever likelihood.
        deviation = standard_deviations(fit)
        known = [
            place
            for place, one in enumerate(fit.free)
            if 0.0 < deviation.get((one.key, one.name), 0.0) < np.inf and fit.strengths[place] == 0.0
        ]
        ends = Profile(fit, fit.covariance(), quantile_95(fit)).intervals(known)
        factors = noise_factors(fit)
        for place, (low, high) in ends.items():
            free, factor = fit.free[place], float(factors[place])
            value = value_of(fit.chain, free)
            found[free.key, free.name] = (value - factor * (value - low), value + factor * (high - value))
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
