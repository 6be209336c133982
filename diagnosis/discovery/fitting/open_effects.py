"""Effects that may stand beside the causes unseen: most of what such a one does, a cause that is there does as well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.coefficients import observables_to_cosine
from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.fitting.joint_fit import Fit, cost_of, evaluate, root_weights
from diagnosis.discovery.fitting.nuisance import without_nuisance
from diagnosis.discovery.fitting.projection import projected
from twin.angles import Array
from twin.catalogue import find, unnamed
from twin.effect import Effect

_TAKEN = 0.5
"""Share of an effect's squares that a cause takes, from which on it hides the effect more than it leaves of it."""
_SURE = 100.0
"""Gain in chi-square beyond which nothing becomes surer."""


def open_beside(fit: Fit) -> dict[str, Fit]:
    """The fit with an effect beside the causes that one of them hides, at no strength yet, by the effect's name.

    A harmonic of order 4 that is free in size and phase does most of what a saturation does, which is of that order.
    Were there both, the harmonic alone would be found, and the factors that a saturation moves would stand elsewhere.
    Before a reading is seen the effect is as likely to be as strong as the cause that hides it.
    """
    effects = [effect for effect in fit.chain.effects if _may_be_there(fit, effect)]
    keys = [key for key in dict.fromkeys(one.key for one in fit.free) if not find(key, fit.chain.effects).baseline]
    found: dict[str, Fit] = {}
    if not effects or not keys:
        return found
    residual, jacobian = fit.whitened()
    for effect in effects:
        column = _column(fit, effect, residual.size)
        left = float(np.linalg.norm(projected(column, jacobian)))
        strongest = max(_strength(fit, key, column, left) for key in keys)
        if strongest > 0.0:
            found[effect.name] = _with(fit, effect, strongest)
    return found


def odds_of(beside: Fit, fit: Fit, name: str) -> float:
    """How likely an effect is to stand beside the causes, against none, by what the readings say of both fits.

    Beforehand as likely as not. The readings' share is the ratio of the marginal likelihoods (Laplace): what the fit
    with the effect gains, and how much of what its strength might have been the readings leave.
    """
    (place,) = (place for place, one in enumerate(beside.free) if one.key == name)
    before = find(name, beside.chain.effects).params[beside.free[place].name].prior_sd
    gain = (cost_of(fit) - cost_of(beside)) / fit.variance
    after = float(np.sqrt(beside.covariance()[place, place]))
    odds = after / before * float(np.exp(0.5 * min(gain, _SURE)))
    return odds if np.isfinite(odds) else 0.0


def _may_be_there(fit: Fit, effect: Effect) -> bool:
    """Whether an effect of one strength, and nothing that a search would set beside it, is not among those fitted."""
    others = (*effect.roles("phase"), *effect.roles("level"), *effect.roles("per turn"))
    one = effect.footprint == "mean" and len(effect.roles("strength")) == 1 and not others
    usual = not (effect.baseline or effect.repeatable or unnamed(effect.name))
    seen = effect.visible_in(fit.observations.motion.provides)
    return one and usual and seen and effect.name not in fit.chain.values


def _column(fit: Fit, effect: Effect, size: int) -> Array:
    """What an effect of strength one does to the whitened residual (N,), at the end of which is what priors hold."""
    columns = without_nuisance(fit.observations, fit.linear.columns(effect, [{}])[0])
    root = root_weights(fit.weighting, fit.observations.observables)
    column = (observables_to_cosine(fit.observations, columns)[0] * root).ravel()
    return np.concatenate([column, np.zeros(size - column.size)])


def _strength(fit: Fit, key: str, column: Array, left: float) -> float:
    """With which strength a column (N,) does as much as a cause that takes most of it; 0 where that takes less.

    Beside what all others can do; ``left`` is the root of the squares that all and the cause leave of the column.
    """
    others = fit.whitened_columns([place for place, one in enumerate(fit.free) if one.key != key])
    alone = float(np.linalg.norm(projected(column, others)))
    if left**2 > (1.0 - _TAKEN) * alone**2 or alone == 0.0:
        return 0.0
    without = evaluate(fit.chain.without(key), (), fit.observations, fit.weighting).whitened_residual()
    does = without - fit.whitened_residual()[: without.size]
    return float(np.linalg.norm(projected(does, others[:, : without.size]))) / alone


def _with(fit: Fit, effect: Effect, strength: float) -> Fit:
    """The fit with an effect of which nothing is known but that it may be so strong."""
    (name,) = effect.roles("strength")
    held = replace(effect.params[name], prior_sd=strength, prior_mean=effect.params[name].null)
    effects = tuple(
        replace(one, params={**one.params, name: held}) if one.name == effect.name else one for one in fit.chain.effects
    )
    chain = replace(fit.chain, effects=effects).with_values({effect.name: effect.null()})
    return evaluate(chain, (*fit.free, Free(effect.name, name)), fit.observations, fit.weighting)
