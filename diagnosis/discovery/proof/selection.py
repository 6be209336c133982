"""Which causes stay: judged once more in the final fit, and proven on readings that no fit has seen."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.noise_colour import colour_of
from diagnosis.discovery.proof.cause import Named
from diagnosis.discovery.proof.cross_validation import folds, held_out_residuals, rms_deg, scattered
from diagnosis.discovery.proof.family_wise import FamilyWise, family_wise
from diagnosis.discovery.search.likelihood_ratio import drop, settle, take_out
from diagnosis.discovery.search.stepwise import Cause, judge
from twin.angles import Array
from twin.catalogue import base_name
from twin.effect import Effect

SLACK = 1.004
LOST = 1.5
"""Growth of the held-out RMS with a cause above which its fit has not seen what it is about."""
LISTED_LOG_P = float(np.log(0.003))
"""Log of the family-wise probability below which a cause is listed."""
NO_DOUBT_LOG_P = -40.0
"""Log probability of the F test below which no simulation of a size that can be afforded says more."""


def prove(
    fit: Fit, effects: Sequence[Effect], keys: Sequence[str], *, rng: np.random.Generator
) -> tuple[Fit, list[Named], list[Array]]:
    """Entries with their held-out figures; what gains nothing on readings it never saw is no cause.

    ``rng`` draws the sweeps on which the family-wise probabilities are calibrated.
    """
    effects = [e for e in effects if e.visible_in(fit.evidence.motion.provides)]
    keys = list(keys)
    while True:
        views = _views(fit) if keys else []
        causes = sorted((_judged(views, key, effects, keys) for key in keys), key=lambda cause: -cause.gain)
        use = fit.evidence.usable
        ordered = [cause.key for cause in causes]
        fold = folds(fit)
        held = held_out_residuals(fit, ordered, fold)
        weighed = [rms_deg(residual / fit.evidence.scale, use) for residual in held]
        if fit.setting.member == 0 and _lost(weighed):
            # Narrower than a block, in one turn: held out as a whole, it leaves its parameters free to go anywhere.
            fold = scattered(fit)
            held = held_out_residuals(fit, ordered, fold)
            weighed = [rms_deg(residual / fit.evidence.scale, use) for residual in held]
        idle = None
        family = _calibrated(fit, effects, causes, rng)
        for place, key in enumerate(ordered):
            if _by_chance(family, causes[place], effects) > LISTED_LOG_P:
                # Or what was added after it has taken over what it was added for.
                idle = key
                break
            if weighed[place + 1] < weighed[place]:
                continue
            # Not the last step: its turn may come only with what was added after it.
            alone = held_out_residuals(fit, [*(k for k in ordered if k != key), key], fold)
            # The RMS counts correlated noise in full: a strong cause that leaves it as it is shows elsewhere.
            slack = SLACK if causes[place].log_p < np.log(1e-10) else 1.0
            before, after = (rms_deg(residual / fit.evidence.scale, use) for residual in alone[-2:])
            if after >= slack * before:
                idle = key
                break
        if idle is None:
            break
        fit, _ = settle(drop(fit, idle))
        keys.remove(idle)
    figures = [rms_deg(residual, use) for residual in held]
    entries = [
        Named(
            (cause.key,),
            cause.log_p,
            cause.gain,
            cause.rivals,
            family_log_p=_by_chance(family, cause, effects),
            before_deg=figures[place],
            after_deg=figures[place + 1],
        )
        for place, cause in enumerate(causes)
    ]
    return fit, entries, held


def _lost(rms: Sequence[float]) -> bool:
    """Whether any step makes the held-out RMS much worse."""
    return any(after > LOST * before for before, after in itertools.pairwise(rms))


def _calibrated(
    fit: Fit, effects: Sequence[Effect], causes: Sequence[Cause], rng: np.random.Generator
) -> FamilyWise | None:
    """The scores that the effects reach on sweeps without any of the causes; None where none of these is in doubt."""
    if all(cause.log_p < NO_DOUBT_LOG_P for cause in causes):
        return None
    baseline = fit
    for cause in causes:
        baseline = take_out(baseline, cause.key)
    return family_wise(solve(baseline), fit, colour_of(fit), effects, rng=rng)


def _by_chance(family: FamilyWise | None, cause: Cause, effects: Sequence[Effect]) -> float:
    """Log of the family-wise probability of a cause: calibrated, or the F test's where that leaves no doubt."""
    if family is None:
        return cause.log_p + float(np.log(max(len(effects), 1)))
    return family.log_p(base_name(cause.key), cause.log_p)


def _views(fit: Fit) -> list[Fit]:
    """The fit; on coloured noise also the fit without the output's stairs.

    A slow noise shifts whole runs of readings against the stairs, which a cause may then seem to set right.
    """
    if fit.setting.member == 0 or "output_quantisation" not in fit.chain.values:
        return [fit]
    chain = fit.chain.without("output_quantisation")
    return [fit, settle(solve(evaluate(chain, fit.free, fit.evidence, fit.setting)))[0]]


def _judged(views: Sequence[Fit], key: str, effects: Sequence[Effect], keys: Sequence[str]) -> Cause:
    """The cause as the least favourable view judges it."""
    return max((judge(view, key, effects, keys) for view in views), key=lambda cause: cause.log_p)
