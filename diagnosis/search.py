"""The search: add the cause that gains most, refit everything exactly, prune, try every swap; until nothing is left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from diagnosis.addition import FAIR_SHARE, best_addition, best_together, candidates, retuned
from diagnosis.footprints import stairs_rule
from diagnosis.joint_fit import Fit
from diagnosis.noise_choice import plausible_members
from diagnosis.screening import Base, screen_one
from diagnosis.trial import (
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
    take_out,
)
from twin.catalogue import base_name, find
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

    @property
    def named(self) -> bool:
        """Whether the catalogue has a name for it."""
        return not base_name(self.key).startswith("unnamed")


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
    for key in [k for k in keys if base_name(k).startswith("unnamed")]:
        fit, keys = in_its_place(fit, key, effects, keys, threshold)
    return Found(fit, tuple(keys), len(effects))


def beside(fit: Fit, keys: Sequence[str], threshold: float) -> float:
    """The log probability to fall below, lower beside a shape without a name.

    Such a shape describes something only nearly, and what it leaves may pass for a weak cause; unless the noise is
    coloured, which what it leaves is taken for.
    """
    nearly = fit.setting.member == 0 and any(base_name(key).startswith("unnamed") for key in keys)
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
            without = drop(fit, key)
            others = [k for k in keys if k != key]
            removed = take_out(fit, key)
            base = Base.of(removed)
            effect = find(key, fit.chain.effects)
            before = likelihood(without)
            gain = 2.0 * (likelihood(fit) - before)
            terms = degrees(effect, len(without.linear.terms(effect)))
            own = screen_one(base, effect)
            looks = own.looks if own is not None else 1.0
            log_p = judged_p(gain, terms, base.dof, looks)
            if log_p + handicap(effect, fit) > beside(fit, others, threshold):
                fit, keys, changed = without, others, True
                continue
            # First order undervalues a large gain, of the cause itself as of its rivals: like is held against like.
            own_first = own.log_p if own is not None else log_p
            score = max(log_p, own_first) + handicap(effect, fit)
            ranked = candidates(base, contenders.get(key, effects), others)
            # The zeros of the turns cost a scatter, not a coefficient each: first order undervalues them.
            for rival in [*ranked[:3], *(c for c in ranked[3:] if c.effect.roles("per turn"))]:
                if rival.effect.name == effect.name or rival.log_p + handicap(rival.effect, fit) > score + 8.0:
                    continue
                trial = Trial.of(removed, rival)
                members = tuple(sorted({*plausible_members(fit), *trial.members}))
                own_gain = 2.0 * (likelihood(fit, members) - likelihood(without, members))
                own_p = judged_p(own_gain, terms, base.dof, looks)
                lead = (
                    own_p
                    + handicap(effect, fit)
                    - trial.log_p(without, members, base.dof)
                    - handicap(rival.effect, fit)
                )
                if lead > SWAP_MARGIN:
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
    named = [e for e in effects if not e.name.startswith("unnamed")]
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
        members = tuple(sorted({*fit.setting.plausible, *trial.setting.plausible}))
        before = likelihood(without, members)
        own = 2.0 * (likelihood(fit, members) - before)
        own_p = judged_p(own, degrees(effect, len(without.linear.terms(effect))), base.dof, 1.0) + handicap(effect, fit)
        gains.append(2.0 * (likelihood(trial, members) - before))
        fair = min(np.diff(gains)) > FAIR_SHARE * gains[-1]
        if fair and judged_p(gains[-1], terms, base.dof, 1.0) + log_looks < own_p:
            return trial, [*others, *added]
    return fit, keys


def judge(fit: Fit, key: str, effects: Sequence[Effect], keys: Sequence[str]) -> Cause:
    """What a cause gains in the final fit, and which named effects in its place would fit as well."""
    effects = [e for e in effects if e.visible_in(fit.evidence.motion.provides)]
    # Without it the noise stays what it is with it: else structure that comes back would pass for noise.
    without = drop(fit, key)
    removed = take_out(fit, key)
    base = Base.of(removed)
    before = likelihood(without)
    gain = 2.0 * (likelihood(fit) - before)
    effect = find(key, fit.chain.effects)
    terms = degrees(effect, len(without.linear.terms(effect)))
    own = screen_one(base, effect)
    looks = own.looks if own is not None else 1.0
    log_p = judged_p(gain, terms, base.dof, looks)
    rivals: dict[str, Fit] = {}
    # What a fit's stairs leave of themselves favours now one smooth shape, now another.
    same = SAME_FIT * (4.0 if fit.setting.coarse else 1.0)
    if not effect.name.startswith("unnamed"):
        present = {base_name(k) for k in keys}
        for other in effects:
            if other.name == effect.name or other.name in present or other.name.startswith("unnamed"):
                continue
            rival = screen_one(base, other)
            if rival is None or rival.gain < 0.3 * min(gain, own.gain if own is not None else gain) - same:
                continue
            trial, _ = add(removed, rival)
            rival_gain = 2.0 * (likelihood(trial) - before)
            if other.roles("per turn"):
                # A step between two turns is a special case of a zero for each turn: what fits counts, not its price.
                rival_gain = max(rival_gain, rival.gain)
            if rival_gain > gain - same:
                rivals[other.name] = trial
    return Cause(key, gain, log_p, rivals)
