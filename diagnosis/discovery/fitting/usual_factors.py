"""Usual factors: a fit that knows how far the factors of the error model differ among devices of one kind.

Where an effect does to an angle what the factors do, factor and effect may cancel at any size. Only what is known of
such devices before a sweep says that they hardly do.
"""

from __future__ import annotations

from dataclasses import replace

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from twin.effect import Effect


def with_usual_factors(fit: Fit) -> Fit:
    """The fit with every factor held by what is usual, and solved again."""
    chain = replace(fit.chain, effects=tuple(map(_usual, fit.chain.effects)))
    return solve(evaluate(chain, fit.free, fit.observations, fit.weighting))


def _usual(effect: Effect) -> Effect:
    """A factor's effect with a prior as wide as devices differ; any other as it is.

    The half width of that range counts as a standard deviation, so that a device outside of it is no wonder.
    """
    if not effect.baseline:
        return effect
    params = {
        name: replace(param, prior_sd=param.scatter, prior_mean=param.null) if param.scatter > 0.0 else param
        for name, param in effect.params.items()
    }
    return replace(effect, params=params)
