"""Details: parameters of a cause that are freed from their nulls only where the readings call for them."""

from __future__ import annotations

from collections.abc import Sequence

from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise.plausible import either, plausible_members
from diagnosis.discovery.search.forward_step import best_addition
from diagnosis.discovery.search.freed import detail_log_p, with_detail
from diagnosis.discovery.search.likelihood_ratio import judged_p, likelihood, refit, settle
from twin.catalogue import find
from twin.effect import Effect


def detailed(fit: Fit, keys: Sequence[str], level: float, effects: Sequence[Effect] = ()) -> Fit:
    """The fit with the details of each cause free where they pay, and at their nulls where they do not.

    A detail pays where noise gains as much only with a log probability below ``level``, as a cause must, and where none
    of ``effects`` as a further cause explains the same surely better: a search that went on from the detail would not
    come to it.
    """
    provides = fit.observations.motion.provides
    for key in keys:
        for name in find(key, fit.chain.effects).details(provides):
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
        plain, freed = fit, with_detail(fit, detail, level)
        if freed is None:
            return fit
        wide = freed
    log_p = detail_log_p(plain, wide)
    if log_p >= level:
        return plain
    surely = log_p - fit.settings.swap_log_odds
    return plain if _by_another_cause(plain, effects, keys, min(level, surely)) < surely else wide


def _by_another_cause(plain: Fit, effects: Sequence[Effect], keys: Sequence[str], level: float) -> float:
    """The log probability by chance of what the best further cause explains beside causes without the detail.

    Those are fitted that to first order may come below the level; 0 where none does.
    """
    without, base = settle(plain)
    step = best_addition(without, base, effects, keys, level + plain.settings.contender_nats)
    if step is None:
        return 0.0
    members = either(plausible_members(without), plausible_members(step.fit))
    gain = 2.0 * (likelihood(step.fit, members) - likelihood(without, members))
    return judged_p(gain, step.terms, plain.freedom, 1.0) + step.log_looks
