"""The search: add the cause that gains most, refit everything exactly, prune, try every swap; until nothing is left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from diagnosis.footprints import stairs_rule
from diagnosis.joint_fit import BASELINE, Fit, Free, evaluate, free_of, solve, tidy
from diagnosis.noise_choice import plausible_members
from diagnosis.screening import Base, Candidate, log_probability, screen, screen_one
from twin.catalogue import base_name, find
from twin.chain import Chain
from twin.effect import Effect

ALPHA = 0.003
"""Family-wise probability of a false alarm above which nothing is added."""
HANDICAP = 6.0
"""What a shape without a name must gain (in nats) beyond one with a name."""
SWAP_MARGIN = 2.0
"""What a swap must gain (in nats): less is noise."""
SAME_FIT = 9.0
"""Difference of twice the log likelihood, three sigma, below which two causes cannot be told apart."""
STAIRS_LOG_P = -40.0
MOST_CAUSES = 8
FAIR_SHARE = 0.15
"""Share of a cause's first gain that another effect must reach to be tried in its place later."""
SMALLEST_RMS_RAD = 1e-6
"""Residual RMS below which nothing is searched for: 6e-5 deg, less than a step of a 22-bit word."""
REPEATABLE = frozenset({"drive_ripple", "magnet_harmonic"})


@dataclass(frozen=True, eq=False)
class Cause:
    """One found cause: its instance key, what it gains, and the named effects that would do as well."""

    key: str
    gain: float
    log_p: float
    rivals: tuple[str, ...] = ()

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


def likelihood(fit: Fit, members: tuple[int, ...] | None = None) -> float:
    """Restricted log likelihood of a fit at the best noise of ``members`` (its own plausible ones if not given).

    The baseline's coefficients are integrated out, and so are the turns' own zeros, which are draws from a
    distribution with the scatter that they show: a common cause of many turns' zeros gains by making them scatter less.
    """
    family = fit.setting.family
    base = [k for k, free in enumerate(fit.free) if free in BASELINE]
    turns = [k for k, free in enumerate(fit.free) if free.turn is not None]
    integrated = [*base, *turns]
    dof = fit.rows * fit.evidence.observables - len(base)
    prior = float(np.sum(np.log(np.abs(fit.prior_jacobian[turns].sum(axis=1))))) if turns else 0.0
    best = -np.inf
    for member in members or fit.setting.plausible:
        r, j = fit.whitened(member)
        _, log_det = np.linalg.slogdet(j[integrated] @ j[integrated].T + 1e-300 * np.eye(len(integrated)))
        best = max(best, -0.5 * (dof * np.log(max(float(r @ r), 1e-300)) + family.log_det[member] + log_det))
    return float(best) + prior


def judged_p(gain: float, terms: int, dof: int, looks: float) -> float:
    """Log probability that noise gains as much (twice the log likelihood) at any of so many looks."""
    return float(log_probability(np.array(gain), terms, dof)) + float(np.log(looks))


def degrees(effect: Effect, terms: int) -> int:
    """Degrees of freedom of an effect in the likelihood: one, the scatter, where coefficients are integrated out."""
    return 1 if effect.roles("per turn") else terms


def refit(chain: Chain, free: Sequence[Free], like: Fit, *, iterations: int = 12) -> Fit:
    """Fit a chain's free parameters to the evidence of another fit."""
    fit = solve(evaluate(chain, tuple(free), like.evidence, like.setting), iterations=iterations)
    return replace_chain(fit, tidy(fit.chain))


def replace_chain(fit: Fit, chain: Chain) -> Fit:
    """The fit with an equivalent chain (phases and signs made tidy)."""
    return evaluate(chain, fit.free, fit.evidence, fit.setting)


def settle(fit: Fit) -> tuple[Fit, Base]:
    """Let the fit take the noise that fits it best, the radius its own noise, and solve again."""
    fit = replace(fit, setting=replace(fit.setting, members=plausible_members(fit)))
    for _ in range(3):
        base = Base.of(fit)
        setting = replace(fit.setting, member=base.member, **_radius_setting(fit))
        same = setting.member == fit.setting.member and np.isclose(
            setting.radius_weight, fit.setting.radius_weight, rtol=0.05
        )
        if same and setting.radius_member == fit.setting.radius_member:
            return fit, base
        fit = solve(evaluate(fit.chain, fit.free, fit.evidence, setting))
    return fit, Base.of(fit)


def _radius_setting(fit: Fit) -> dict[str, Any]:
    """Noise member of the radius and its weight against the angle, each from its own residual."""
    if fit.evidence.observables == 1:
        return {}
    family = fit.setting.family
    squares = (fit.cosine_residual[1] ** 2) @ family.weights.T
    members = -0.5 * (fit.rows * np.log(np.maximum(squares, 1e-300)) + family.log_det)
    member = int(np.argmax(members))
    angle = float(np.mean(fit.cosine_residual[0] ** 2 * family.weights[fit.setting.member]))
    radius = float(np.mean(fit.cosine_residual[1] ** 2 * family.weights[member]))
    # The channels' noise is as large along the radius as across it: the radius never counts for more than that.
    return {"radius_member": member, "radius_weight": min(angle / max(radius, 1e-300), 1.0)}


def add(fit: Fit, candidate: Candidate) -> tuple[Fit, str]:
    """The joint fit with the candidate added, and the key it got."""
    name = candidate.effect.name
    taken = sum(1 for key in fit.chain.values if base_name(key) == name)
    key = name if taken == 0 else f"{name}#{taken + 1}"
    chain = fit.chain.with_values({key: dict(candidate.effect.begin(candidate.values))})
    turns = int(fit.evidence.motion.turn.max(initial=0)) + 1
    free = free_of(candidate.effect, key, turns=turns, channels=fit.evidence.observables == 2)
    return refit(chain, (*fit.free, *free), fit), key


def drop(fit: Fit, key: str) -> Fit:
    """The joint fit without this instance."""
    return refit(fit.chain.without(key), [f for f in fit.free if f.key != key], fit)


@dataclass(frozen=True, eq=False)
class Trial:
    """A candidate fitted exactly: its joint fit, its key, and the noise that is plausible with it."""

    candidate: Candidate
    fit: Fit
    key: str
    members: tuple[int, ...]

    @classmethod
    def of(cls, fit: Fit, candidate: Candidate) -> Trial:
        """Add the candidate to the fit."""
        trial, key = add(fit, candidate)
        return cls(candidate, trial, key, plausible_members(trial))

    def log_p(self, before: Fit, members: tuple[int, ...], dof: int) -> float:
        """Log probability that noise of these members gains as much."""
        gain = 2.0 * (likelihood(self.fit, members) - likelihood(before, members))
        terms = degrees(self.candidate.effect, self.candidate.terms)
        return judged_p(gain, terms, dof, self.candidate.looks)


def handicap(effect: Effect) -> float:
    """What an effect without a name has to gain beyond the others."""
    if effect.name == "unnamed_tone":
        # On a shaft that steps evenly a tone in time is an order too: the order is the plainer description.
        return HANDICAP + 2.0
    return HANDICAP if effect.name.startswith("unnamed") else 0.0


def search(fit: Fit, effects: Sequence[Effect], *, keys: Sequence[str] = (), alpha: float = ALPHA) -> Found:
    """Find the causes among ``effects`` that the fit's chain lacks; ``keys`` are those found before, open to revision.

    The causes come without a judgement of their rivals: see :func:`judge`.
    """
    effects = [e for e in effects if e.visible_in(fit.evidence.motion.provides)]
    threshold = float(np.log(alpha / max(len(effects), 1)))
    if stairs_rule(fit):
        # Stairs alias into lines and steps that no smooth model of them takes out: only what is beyond doubt counts.
        threshold = min(threshold, STAIRS_LOG_P)
    keys = list(keys)
    contenders: dict[str, list[Effect]] = {}
    barred: set[str] = set()
    fit, base = settle(fit)
    if keys:
        fit, keys = improve(fit, effects, keys, threshold, contenders)
        fit, base = settle(fit)
    while len(keys) < MOST_CAUSES and _stands_out(fit):
        step = best_addition(fit, base, [e for e in effects if e.name not in barred], keys, threshold)
        if step is None:
            break
        fit, key, contenders[step[1]] = step
        keys.append(key)
        fit, base = settle(fit)
        fit, keys = improve(fit, effects, keys, threshold, contenders)
        fit, base = settle(fit)
        if step[1] not in keys:
            # Pruned or swapped out at once: offered again, it would only go round.
            barred.add(base_name(step[1]))
    return Found(fit, tuple(keys), len(effects))


def _stands_out(fit: Fit) -> bool:
    """Whether anything is left that a file's digits could carry: below, the last digit itself is the structure."""
    return float(np.mean(fit.residual[0][fit.evidence.usable] ** 2)) > SMALLEST_RMS_RAD**2


def candidates(base: Base, effects: Sequence[Effect], keys: Sequence[str]) -> list[Candidate]:
    """Every effect that may still be added, at its best shape, best first after the handicap."""
    present = {base_name(key) for key in keys}
    open_to = [e for e in effects if e.name not in present or e.name in REPEATABLE or e.name.startswith("unnamed")]
    found = screen(base, open_to)
    found += multiples(base, effects, keys)
    return sorted(found, key=lambda c: c.log_p + handicap(c.effect))


def multiples(base: Base, effects: Sequence[Effect], keys: Sequence[str]) -> list[Candidate]:
    """A drive's ripple comes with its multiples, also where these alias to other orders."""
    found = []
    for effect in effects:
        if effect.name != "drive_ripple":
            continue
        for key in keys:
            if base_name(key) != effect.name:
                continue
            order = float(base.fit.chain.values[key]["order"])
            # Near the number of points a turn an order is a slow function of the row: no ripple is told from it.
            highest = 0.9 * base.fit.evidence.motion.points_per_turn
            shapes = [{"order": order * k} for k in (2, 3, 4, 5) if order * k < highest]
            candidate = screen_one(base, effect, shapes=shapes)
            if candidate is not None:
                found.append(candidate)
    return found


def best_addition(
    fit: Fit, base: Base, effects: Sequence[Effect], keys: Sequence[str], threshold: float
) -> tuple[Fit, str, list[Effect]] | None:
    """The joint fit with the best significant candidate, contenders compared by exact fits; None if there is none.

    With it come the effects that explain a fair part of what it does: those that may take its place later.
    """
    ranked = [c for c in candidates(base, effects, keys) if c.log_p + handicap(c.effect) < threshold]
    if not ranked:
        return None
    top = ranked[0].log_p + handicap(ranked[0].effect)
    near = [c for c in ranked if c.log_p + handicap(c.effect) < top + max(8.0, -0.1 * top)][:5]
    trials = [Trial.of(fit, c) for c in near]
    # All are judged by the same noises: those that any of them leaves.
    members = tuple(sorted(set().union(*(t.members for t in trials))))
    judged = [(t.log_p(fit, members, base.dof) + handicap(t.candidate.effect), k) for k, t in enumerate(trials)]
    score, place = min(judged)
    if score > threshold:
        return None
    trial, key, chosen = trials[place].fit, trials[place].key, trials[place].candidate
    fair = [c.effect for c in ranked if c.gain > FAIR_SHARE * chosen.gain]
    return trial, key, list({effect.name: effect for effect in fair}.values())


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
        for key in list(keys):
            if key not in keys or len(keys) < 2:
                continue
            without = drop(fit, key)
            others = [k for k in keys if k != key]
            base = Base.of(without)
            effect = find(key, fit.chain.effects)
            before = likelihood(without)
            gain = 2.0 * (likelihood(fit) - before)
            terms = degrees(effect, len(without.linear.terms(effect)))
            own = screen_one(base, effect)
            looks = own.looks if own is not None else 1.0
            log_p = judged_p(gain, terms, base.dof, looks)
            if log_p + handicap(effect) > threshold:
                fit, keys, changed = without, others, True
                continue
            score = log_p + handicap(effect)
            ranked = candidates(base, contenders.get(key, effects), others)
            # The zeros of the turns cost a scatter, not a coefficient each: first order undervalues them.
            for rival in [*ranked[:3], *(c for c in ranked[3:] if c.effect.roles("per turn"))]:
                if rival.effect.name == effect.name or rival.log_p + handicap(rival.effect) > score + 8.0:
                    continue
                trial = Trial.of(without, rival)
                members = tuple(sorted({*plausible_members(fit), *trial.members}))
                own_gain = 2.0 * (likelihood(fit, members) - likelihood(without, members))
                own_p = judged_p(own_gain, terms, base.dof, looks)
                lead = own_p + handicap(effect) - trial.log_p(without, members, base.dof) - handicap(rival.effect)
                if lead > SWAP_MARGIN:
                    contenders[trial.key] = contenders.get(key, list(effects))
                    fit, keys, changed = trial.fit, [*others, trial.key], True
                    break
        if not changed:
            break
    return fit, keys


def judge(fit: Fit, key: str, effects: Sequence[Effect], keys: Sequence[str]) -> Cause:
    """What a cause gains in the final fit, and which named effects in its place would fit as well."""
    effects = [e for e in effects if e.visible_in(fit.evidence.motion.provides)]
    # Without it the noise stays what it is with it: else structure that comes back would pass for noise.
    without = drop(fit, key)
    base = Base.of(without)
    before = likelihood(without)
    gain = 2.0 * (likelihood(fit) - before)
    effect = find(key, fit.chain.effects)
    terms = degrees(effect, len(without.linear.terms(effect)))
    own = screen_one(base, effect)
    looks = own.looks if own is not None else 1.0
    log_p = judged_p(gain, terms, base.dof, looks)
    rivals: list[str] = []
    if not effect.name.startswith("unnamed"):
        present = {base_name(k) for k in keys}
        for other in effects:
            if other.name == effect.name or other.name in present or other.name.startswith("unnamed"):
                continue
            rival = screen_one(base, other)
            if rival is None or rival.gain < 0.3 * gain - SAME_FIT:
                continue
            trial, _ = add(without, rival)
            rival_gain = 2.0 * (likelihood(trial) - before)
            if other.roles("per turn"):
                # A step between two turns is a special case of a zero for each turn: what fits counts, not its price.
                rival_gain = max(rival_gain, rival.gain)
            if rival_gain > gain - SAME_FIT:
                rivals.append(other.name)
    return Cause(key, gain, log_p, tuple(rivals))
