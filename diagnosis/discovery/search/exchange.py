"""Exchange: causes that no longer pay are removed, and each is held against what could stand in its place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise.plausible import either, plausible_members
from diagnosis.discovery.search.details import detailed
from diagnosis.discovery.search.forward_step import best_addition, candidates, retuned
from diagnosis.discovery.search.likelihood_ratio import (
    Trial,
    degrees,
    doubt_beside,
    drop,
    ends_at_bound,
    handicap,
    judged_p,
    likelihood,
    settle,
)
from diagnosis.discovery.search.parts import lacks_a_part
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.search.screening import Candidate
from diagnosis.discovery.search.standing import Contest, Form, Standing, form_of
from twin.catalogue import find, found_together, unnamed
from twin.effect import Effect


@dataclass(frozen=True, eq=False)
class Search:
    """What is searched for, and by which rule.

    ``effects`` are those that the recording can show, ``threshold`` the log probability by chance that one of them
    must fall below, ``contenders`` by key the effects that explained a fair part of what that cause was added for.
    """

    effects: tuple[Effect, ...]
    threshold: float
    contenders: Mapping[str, Sequence[Effect]]

    @classmethod
    def among(cls, effects: Sequence[Effect], fit: Fit) -> Search:
        """The search of a fit for these effects."""
        provides = fit.observations.motion.provides
        visible = tuple(effect for effect in effects if effect.visible_in(provides) and not found_together(effect))
        threshold = fit.settings.effect_log_p(len(visible))
        if fit.weighting.coarse:
            # No smooth model of coarse stairs takes all of them out: only what is beyond doubt counts.
            threshold = min(threshold, -fit.settings.stairs_log_odds)
        return cls(visible, threshold, {})

    def with_contenders(self, added: Mapping[str, Sequence[Effect]]) -> Search:
        """The same search, which knows what contended for the place of the causes added."""
        return replace(self, contenders={**self.contenders, **added})

    def level_beside(self, fit: Fit, keys: Sequence[str]) -> float:
        """The log probability to fall below beside these causes."""
        return self.threshold - doubt_beside(fit, keys)


def improve(
    fit: Fit, keys: Sequence[str], plan: Search, standings: Mapping[str, Standing] | None = None
) -> tuple[Fit, list[str], Mapping[str, Standing]]:
    """Remove what no longer pays, exchange what another explains better; repeat while anything changes.

    Returned are the fit, its causes, and by key how they stand; ``standings`` says so of those known from before.
    """
    held, known = list(keys), dict(standings or {})
    for _ in range(fit.settings.most_rounds):
        before = list(held)
        fit = detailed(retuned(fit, held), held, plan.threshold, plan.effects)
        for key in before:
            if key not in held or len(held) < 2:
                continue
            stood = known.get(key)
            if stood is not None and stood.seen_in is fit:
                # In the very fit in which it was examined.
                continue
            examined = _held_or_exchanged(fit, key, held, plan, stood)
            if examined.standing is None:
                # What takes its place may have its key.
                known = {other: known[other] for other in known if other != key and other in examined.keys}
            else:
                known[key] = examined.standing
            fit, held, plan = examined.fit, examined.keys, examined.plan
        if held == before:
            break
    return fit, held, known


@dataclass(frozen=True, eq=False)
class _Examined:
    """What an examination of a cause ends with; ``standing`` where the cause keeps its place."""

    fit: Fit
    keys: list[str]
    plan: Search
    standing: Standing | None = None


def _held_or_exchanged(fit: Fit, key: str, keys: list[str], plan: Search, stood: Standing | None) -> _Examined:
    """The fit with this cause, without it, or with another in its place."""
    others = [other for other in keys if other != key]
    removal, level = Removal.of(fit, key), plan.level_beside(fit, others)
    contenders = plan.contenders.get(key, plan.effects)
    paying = stood if stood is not None and stood.pays_still(removal, level) else None
    idle = paying is None and removal.log_p + handicap(removal.effect, fit) > level
    if idle or ends_at_bound(fit, key) or lacks_a_part(fit, key, fit.settings.footprint_log_p):
        return _Examined(removal.without, others, plan)
    ranked = candidates(removal.base, contenders, others, known=removal.own)
    if paying is not None and paying.beats_still(removal, _rivals(fit, removal, ranked, log_p=paying.now(removal))):
        return _Examined(fit, keys, plan, replace(paying, seen_in=fit))
    contests: dict[Form, Contest] = {}
    for rival in _rivals(fit, removal, ranked):
        trial = Trial.of(removal.removed, rival)
        members = either(plausible_members(fit), trial.members)
        own_gain = 2.0 * (likelihood(fit, members) - likelihood(removal.without, members))
        own_p = removal.judged(own_gain) + handicap(removal.effect, fit)
        rival_p = trial.log_p(removal.without, members, removal.base.dof) + handicap(rival.effect, fit)
        lost_by = rival_p - own_p + fit.settings.swap_log_odds
        if lost_by < 0.0:
            plan = plan.with_contenders({trial.key: contenders})
            return _Examined(trial.fit, [*others, trial.key], plan)
        contests[form_of(rival, fit)] = Contest(lost_by, rival.log_p - _first(removal))
    return _Examined(fit, keys, plan, Standing(fit, removal.log_p, _first(removal), contests))


def _first(removal: Removal) -> float:
    """Log probability of what a cause gains to first order, or where that cannot be had, of its exact gain."""
    return removal.own.log_p if removal.own is not None else removal.log_p


def _rivals(fit: Fit, removal: Removal, ranked: Sequence[Candidate], *, log_p: float | None = None) -> list[Candidate]:
    """Those of the candidates, ranked by their first-order scores, that may do better in the place of a cause.

    ``log_p`` is that of the cause where it is known without an exact fit.
    """
    # First order undervalues a large gain, of the cause itself as of its rivals: like is held against like.
    exact = removal.log_p if log_p is None else log_p
    score = max(exact, _first(removal)) + handicap(removal.effect, fit) + fit.settings.contender_nats
    most = fit.settings.most_rivals
    # The zeros of the turns cost a scatter, not a coefficient each: first order undervalues them.
    chosen = [*ranked[:most], *(c for c in ranked[most:] if c.effect.roles("per turn"))]
    return [c for c in chosen if c.effect.name != removal.effect.name and c.log_p + handicap(c.effect, fit) <= score]


def in_its_place(fit: Fit, key: str, keys: list[str], plan: Search) -> tuple[Fit, list[str]]:
    """The fit with several named causes in the place of one shape without a name, where they explain as much.

    Each has to do a fair share of it: any shape can be had from a cause that is near to it and another's small help.
    """
    named = [effect for effect in plan.effects if not unnamed(effect.name)]
    without, base = settle(drop(fit, key))
    effect = find(key, fit.chain.effects)
    trial, others = without, [other for other in keys if other != key]
    added: list[str] = []
    gains = [0.0]
    terms, log_looks = 0, 0.0
    for _ in range(fit.settings.most_in_place):
        step = best_addition(trial, base, named, [*others, *added], plan.threshold)
        if step is None:
            return fit, keys
        added += step.added
        terms, log_looks = terms + step.terms, log_looks + step.log_looks
        trial, base = settle(step.fit)
        members = either(fit.weighting.plausible, trial.weighting.plausible)
        before = likelihood(without, members)
        own = 2.0 * (likelihood(fit, members) - before)
        own_p = judged_p(own, degrees(effect, len(without.linear.terms(effect))), base.dof, 1.0) + handicap(effect, fit)
        gains.append(2.0 * (likelihood(trial, members) - before))
        fair = min(np.diff(gains)) > fit.settings.fair_share * gains[-1]
        if fair and judged_p(gains[-1], terms, base.dof, 1.0) + log_looks < own_p:
            return trial, [*others, *added]
    return fit, keys
