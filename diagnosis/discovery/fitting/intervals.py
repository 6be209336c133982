"""How well a fit knows its parameters: standard deviations, and the quantile that makes 95 % intervals of them."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from twin.catalogue import find

Deviations = dict[tuple[str, str], float]
"""Standard deviation of a parameter, by effect and parameter."""
_TWO_SIDED_95 = 0.975


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


def may_be_null(fit: Fit, key: str) -> bool:
    """Whether the 95 % interval of every strength of a cause holds its null, so that nothing may be there.

    Of a line it is that of the amplitude, of a zero for each turn that of their spread. What has no strength that a fit
    moves, such as a whole number of bits, is not asked.
    """
    effect, values = find(key, fit.chain.effects), fit.chain.values.get(key, {})
    reach, deviations = quantile_95(fit), standard_deviations(fit)
    asked = [name for name in (*effect.roles("strength"), *effect.roles("level")) if (key, name) in deviations]
    if any(abs(float(values[name]) - effect.params[name].null) > reach * deviations[key, name] for name in asked):
        return False
    told = effect.derived(values) if effect.roles("per turn") else {}
    spreads = [low for name, (_, low, _, _) in told.items() if name in effect.params]
    return bool(asked or spreads) and not any(low > 0.0 for low in spreads)
