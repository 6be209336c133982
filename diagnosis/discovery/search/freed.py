"""Freed: a detail of a cause moved from its null, and what that is worth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate
from diagnosis.discovery.fitting.noise.plausible import either, plausible_members
from diagnosis.discovery.fitting.projection import projected
from diagnosis.discovery.search.likelihood_ratio import Trial, judged_p, likelihood, refit
from twin.catalogue import find


def with_detail(fit: Fit, detail: Free, level: float) -> Fit | None:
    """The fit with a detail free; None where to first order it is far from a log probability of ``level`` by chance.

    One that does nothing to first order, as a lag shorter than the time between two readings, sets out from its typical
    size.
    """
    wide = evaluate(fit.chain, (*fit.free, detail), fit.observations, fit.weighting)
    if wide.jacobian[-1].any():
        reach = min(level + fit.settings.contender_nats, level * fit.settings.rival_share)
        return refit(fit.chain, wide.free, fit) if _log_p(_first_order(wide), fit) <= reach else None
    typical = find(detail.key, fit.chain.effects).params[detail.name].typical
    chain = fit.chain.with_values({detail.key: {**fit.chain.values[detail.key], detail.name: typical}})
    begun = evaluate(chain, wide.free, fit.observations, fit.weighting)
    return refit(chain, wide.free, fit) if begun.jacobian[-1].any() else None


def in_detail(trial: Trial, level: float) -> Trial | None:
    """A trial with those details of its cause free that pay, see :func:`with_detail`; None where none does."""
    fit, count = trial.fit, 0
    for name in trial.candidate.effect.details(fit.observations.motion.provides):
        wide = with_detail(fit, Free(trial.key, name), level)
        if wide is not None and detail_log_p(fit, wide) < level:
            fit, count = wide, count + 1
    candidate = replace(trial.candidate, terms=trial.candidate.terms + count)
    return Trial(candidate, fit, trial.key, plausible_members(fit)) if count else None


def detail_log_p(plain: Fit, wide: Fit) -> float:
    """Log probability that noise gains as much by one more parameter."""
    members = either(plausible_members(plain), plausible_members(wide))
    return _log_p(2.0 * (likelihood(wide, members) - likelihood(plain, members)), plain)


def _log_p(gain: float, fit: Fit) -> float:
    return judged_p(gain, 1, fit.freedom, 1.0)


def _first_order(fit: Fit) -> float:
    """What the last free parameter gains, twice the log likelihood, to first order."""
    residual, jacobian = fit.whitened()
    without, left = projected(residual, jacobian[:-1]), projected(residual, jacobian)
    squares = np.maximum([without @ without, left @ left], 1e-300)
    return fit.freedom * float(np.log(squares[0] / squares[1]))
