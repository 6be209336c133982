"""Details: parameters of a cause that are freed from their nulls only where the readings call for them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, Free, evaluate
from diagnosis.discovery.fitting.noise.plausible import either, plausible_members
from diagnosis.discovery.fitting.projection import projected
from diagnosis.discovery.search.forward_step import best_addition
from diagnosis.discovery.search.likelihood_ratio import judged_p, likelihood, refit, settle
from twin.catalogue import find
from twin.effect import Effect


def detailed(fit: Fit, keys: Sequence[str], level: float, effects: Sequence[Effect] = ()) -> Fit:
    """The fit with the details of each cause free where they pay, and at their nulls where they do not.

    A detail pays where noise gains as much only with a log probability below ``level``, as a cause must, and where none
    of ``effects`` as a further cause explains the same surely better: a search that went on from the detail would not
    come to it.
    """
    for key in keys:
        for name in find(key, fit.chain.effects).details:
            fit = _judged(fit, Free(key, name), level, effects=effects, keys=keys)
    return fit


def _judged(fit: Fit, detail: Free, level: float, *, effects: Sequence[Effect], keys: Sequence[str]) -> Fit:
    """The fit with the detail, or without it where that is as good."""
    if detail in fit.free:
        wide = fit
        null = find(detail.key, fit.chain.effects).params[detail.name].null
        chain = fit.chain.with_values({detail.key: {**fit.chain.values[detail.key], detail.name: null}})
        plain = refit(chain, [one for one in fit.free if one != detail], fit)
    else:
        plain, wide = fit, evaluate(fit.chain, (*fit.free, detail), fit.observations, fit.weighting)
        if _log_p(_first_order(wide), fit) > level + fit.settings.contender_nats:
            return fit
        wide = refit(fit.chain, wide.free, fit)
    members = either(plausible_members(plain), plausible_members(wide))
    log_p = _log_p(2.0 * (likelihood(wide, members) - likelihood(plain, members)), fit)
    if log_p >= level:
        return plain
    return plain if _by_another_cause(plain, effects, keys, level) < log_p - fit.settings.swap_log_odds else wide


def _by_another_cause(plain: Fit, effects: Sequence[Effect], keys: Sequence[str], level: float) -> float:
    """The log probability by chance of what the best further cause explains beside causes without the detail."""
    without, base = settle(plain)
    step = best_addition(without, base, effects, keys, level)
    if step is None:
        return 0.0
    members = either(plausible_members(without), plausible_members(step.fit))
    gain = 2.0 * (likelihood(step.fit, members) - likelihood(without, members))
    return judged_p(gain, step.terms, plain.freedom, 1.0) + step.log_looks


def _log_p(gain: float, fit: Fit) -> float:
    return judged_p(gain, 1, fit.freedom, 1.0)


def _first_order(fit: Fit) -> float:
    """What the last free parameter gains, twice the log likelihood, to first order."""
    residual, jacobian = fit.whitened()
    without, left = projected(residual, jacobian[:-1]), projected(residual, jacobian)
    squares = np.maximum([without @ without, left @ left], 1e-300)
    return fit.freedom * float(np.log(squares[0] / squares[1]))
