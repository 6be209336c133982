"""The search: add the cause that gains most, refit everything exactly, prune, try every swap; until nothing is left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise_choice import either, plausible_members
from diagnosis.discovery.marks.footprints import stairs_rule
from diagnosis.discovery.search.forward_step import FAIR_SHARE, best_addition, best_together, candidates, retuned
from diagnosis.discovery.search.likelihood_ratio import (
    HANDICAP,
    SWAP_MARGIN,
    Trial,
    add,
    degrees,
    drop,
    handicap,
    judged_p,
    likelihood,
    settle,
)
from diagnosis.discovery.search.removal import Standing
from diagnosis.discovery.search.screening import screen_one
from twin.catalogue import base_name, find, unnamed
from twin.effect import Effect

ALPHA = 0.001
"""Family-wise probability of a false alarm above which nothing is added."""
SAME_FIT = 9.0
"""Difference of twice the log likelihood, three sigma, below which two causes cannot be told apart."""
STAIRS_LOG_P = -20.0
"""Log probability that a cause must fall below beside coarse stairs."""
MOST_CAUSES = 8
MOST_IN_PLACE = 2
"""So many named causes are tried in the place of one shape without a name."""
SMALLEST_RMS_RAD = 1e-6
"""Residual RMS below which nothing is searched for: 6e-5 deg, less than a step of a 22-bit word."""


@dataclass(frozen=True, eq=False)
class Cause:
    """One found cause: its instance key, what it gains, and the fits with a named effect that would do as well."""

    key: str
    gain: float
    log_p: float
    rivals: Mapping[str, Fit] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Found:
    """What the search ends with: the joint fit, the keys of its causes, and how many effects were looked at."""

    fit: Fit
    keys: tuple[str, ...]
    looked_at: int


def search(fit: Fit, effects: Sequence[Effect], *, keys: Sequence[str] = (), alpha: float = ALPHA) -> Found:
    """Find the causes among ``effects`` that the fit's chain lacks; ``keys`` are those found before, open to revision.

    The causes come without a judgement of their rivals: see :func:`judge`.
    """
    effects = [e for e in effects if e.visible_in(fit.evidence.motion.provides)]
    threshold = float(np.log(alpha / max(len(effects), 1)))
    fit = replace(fit, setting=replace(fit.setting, coarse=stairs_rule(fit)))
    if fit.setting.coarse:
        # No smooth model of coarse stairs takes all of them out: only what is beyond doubt counts.
        threshold = min(threshold, STAIRS_LOG_P)
    keys = list(keys)
    contenders: dict[str, list[Effect]] = {}
    barred: set[str] = set()
    seen: set[frozenset[str]] = set()
    fit, base = settle(fit)
    if keys:
        fit, keys = improve(fit, effects, keys, threshold, contenders)
        fit, base = settle(fit)
    while len(keys) < MOST_CAUSES and _stands_out(fit):
        offered = [e for e in effects if e.name not in barred]
        level = beside(fit, keys, threshold)
        step = best_addition(fit, base, offered, keys, level) or best_together(fit, base, offered, keys, level)
        if step is None:
            break
        contenders.update({key: list(others) for key, others in step.added.items()})
        fit, base = settle(step.fit)
        fit, keys = improve(fit, effects, [*keys, *step.added], threshold, contenders)
        fit, base = settle(fit)
        # Pruned or swapped out at once: offered again, it would only go round.
        idle = {base_name(key) for key in step.added if key not in keys}
        barred |= idle
        if not idle and frozenset(keys) in seen:
            # Two causes that take each other's place in turns.
            break
        seen.add(frozenset(keys))
    for key in [k for k in keys if unnamed(k)]:
        fit, keys = in_its_place(fit, key, effects, keys, threshold)
    return Found(fit, tuple(keys), len(effects))


def beside(fit: Fit, keys: Sequence[str], threshold: float) -> float:
    """The log probability to fall below, lower beside a shape without a name.

    Such a shape describes something only nearly, and what it leaves may pass for a weak cause; unless the noise is
    coloured, which what it leaves is taken for.
    """
    nearly = fit.setting.member == 0 and any(unnamed(key) for key in keys)
    return threshold - (HANDICAP if nearly else 0.0)


def _stands_out(fit: Fit) -> bool:
    """Whether anything is left that a file's digits could carry: below, the last digit itself is the structure."""
    return float(np.mean(fit.residual[0][fit.evidence.usable] ** 2)) > SMALLEST_RMS_RAD**2


def improve(
    fit: Fit,
    effects: Sequence[Effect],
    keys: list[str],
    threshold: float,
    contenders: dict[str, list[Effect]],
) -> tuple[Fit, list[str]]:
    """Prune what no longer pays, then try every swap with what contended for its place; repeat while all changes."""
    for _ in range(3):
        changed = False
        fit = retuned(fit, keys)
        for key in list(keys):
            if key not in keys or len(keys) < 2:
                continue
            others = [k for k in keys if k != key]
            standing = Standing.of(fit, key)
            without, effect = standing.without, standing.effect
            if standing.log_p + handicap(effect, fit) > beside(fit, others, threshold):
                fit, keys, changed = without, others, True
                continue
            # First order undervalues a large gain, of the cause itself as of its rivals: like is held against like.
            own_first = standing.own.log_p if standing.own is not None else standing.log_p
            score = max(standing.log_p, own_first) + handicap(effect, fit)
            ranked = candidates(standing.base, contenders.get(key, effects), others)
            # The zeros of the turns cost a scatter, not a coefficient each: first order undervalues them.
            for rival in [*ranked[:3], *(c for c in ranked[3:] if c.effect.roles("per turn"))]:
                if rival.effect.name == effect.name or rival.log_p + handicap(rival.effect, fit) > score + 8.0:
                    continue
                trial = Trial.of(standing.removed, rival)
                members = either(plausible_members(fit), trial.members)
                own_gain = 2.0 * (likelihood(fit, members) - likelihood(without, members))
                own_p = standing.judged(own_gain) + handicap(effect, fit)
                if own_p - trial.log_p(without, members, standing.base.dof) - handicap(rival.effect, fit) > SWAP_MARGIN:
                    contenders[trial.key] = contenders.get(key, list(effects))
                    fit, keys, changed = trial.fit, [*others, trial.key], True
                    break
        if not changed:
            break
    return fit, keys


def in_its_place(
    fit: Fit, key: str, effects: Sequence[Effect], keys: list[str], threshold: float
) -> tuple[Fit, list[str]]:
    """The fit with several named causes in the place of one shape without a name, where they explain as much.

    Each has to do a fair share of it: any shape can be had from a cause that is near to it and another's small help.
    """
    named = [e for e in effects if not unnamed(e.name)]
    without, base = settle(drop(fit, key))
    effect = find(key, fit.chain.effects)
    trial, others = without, [k for k in keys if k != key]
    added: list[str] = []
    gains = [0.0]
    terms, log_looks = 0, 0.0
    for _ in range(MOST_IN_PLACE):
        step = best_addition(trial, base, named, [*others, *added], threshold)
        if step is None:
            return fit, keys
        added += step.added
        terms, log_looks = terms + step.terms, log_looks + step.log_looks
        trial, base = settle(step.fit)
        members = either(fit.setting.plausible, trial.setting.plausible)
        before = likelihood(without, members)
        own = 2.0 * (likelihood(fit, members) - before)
        own_p = judged_p(own, degrees(effect, len(without.linear.terms(effect))), base.dof, 1.0) + handicap(effect, fit)
        gains.append(2.0 * (likelihood(trial, members) - before))
        fair = min(np.diff(gains)) > FAIR_SHARE * gains[-1]
        if fair and judged_p(gains[-1], terms, base.dof, 1.0) + log_looks < own_p:
            return trial, [*others, *added]
    return fit, keys


def judge(fit: Fit, key: str, effects: Sequence[Effect], keys: Sequence[str]) -> Cause:
    """What a cause gains in the final fit, and which named effects (of these, all visible) would fit as well."""
    standing = Standing.of(fit, key)
    effect, own, gain = standing.effect, standing.own, standing.gain
    before = likelihood(standing.without)
    rivals: dict[str, Fit] = {}
    # What a fit's stairs leave of themselves favours now one smooth shape, now another.
    same = SAME_FIT * (4.0 if fit.setting.coarse else 1.0)
    if not unnamed(effect.name):
        present = {base_name(k) for k in keys}
        for other in effects:
            if other.name == effect.name or other.name in present or unnamed(other.name):
                continue
            rival = screen_one(standing.base, other)
            if rival is None or rival.gain < 0.3 * min(gain, own.gain if own is not None else gain) - same:
                continue
            trial, _ = add(standing.removed, rival)
            rival_gain = 2.0 * (likelihood(trial) - before)
            if other.roles("per turn"):
                # A step between two turns is a special case of a zero for each turn: what fits counts, not its price.
                rival_gain = max(rival_gain, rival.gain)
            if rival_gain > gain - same:
                rivals[other.name] = trial
    return Cause(key, gain, standing.log_p, rivals)
