"""Trials: one cause put into or taken out of the joint fit, everything else fitted with it, and what that is worth."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.f_test import log_probability
from diagnosis.discovery.fitting.free_parameters import Free, declared, free_of
from diagnosis.discovery.fitting.joint_fit import SMALL_GAIN, Fit, evaluate, held_anew, solve
from diagnosis.discovery.fitting.noise.plausible import plausible_members, radius_noise
from diagnosis.discovery.fitting.tidy import tidy
from diagnosis.discovery.search.screening import Base, Candidate
from twin.catalogue import find, unnamed
from twin.chain import Chain
from twin.effect import Effect

TO_THE_END = 60
"""Steps of a fit that is not to be left short of its optimum, where it ends by itself."""
SETTLING = 3
"""Times that noise and fit are adapted to one another; the second time the noise hardly ever changes."""


def likelihood(fit: Fit, members: tuple[int, ...] | None = None) -> float:
    """Restricted log likelihood of a fit at the best noise of ``members`` (its own plausible ones if not given).

    The baseline's coefficients are integrated out, and so are strengths that are draws from a distribution: the turns'
    own zeros with the scatter that they show, so that a common cause of many of them gains by making them scatter less;
    the weights of a converter's bits with the scatter that converters show.
    """
    return max(_likelihoods(fit, members or fit.weighting.plausible).values())


def likelihood_of_readings(fit: Fit) -> float:
    """The same without what is known of the parameters before the sweep, but for the scatter of draws."""
    return max(_likelihoods(fit, fit.weighting.plausible, of_readings=True).values())


def _likelihoods(fit: Fit, members: Sequence[int], *, of_readings: bool = False) -> dict[int, float]:
    """The same by family member."""
    family = fit.weighting.family
    effects = [effect for effect, _ in declared(fit.chain, fit.free)]
    base = [k for k, effect in enumerate(effects) if effect.baseline]
    drawn = [k for k, effect in enumerate(effects) if not effect.baseline and fit.free[k].name in effect.drawn]
    integrated = [*base, *drawn]
    dof = fit.rows * fit.observations.observables - len(base)
    prior = float(np.sum(np.log(fit.strengths[drawn]))) if drawn else 0.0
    cost = family.cost(fit.rows)
    known = np.flatnonzero(fit.strengths > 0.0)
    before = float(np.sum(fit.prior_residual[~np.isin(known, drawn)] ** 2)) if of_readings else 0.0
    found = {}
    for member in members:
        r, j = fit.whitened_residual(member), fit.whitened_columns(integrated, member)
        _, log_det = np.linalg.slogdet(j @ j.T + 1e-300 * np.eye(len(integrated)))
        found[member] = prior - 0.5 * float(dof * np.log(max(float(r @ r) - before, 1e-300)) + cost[member] + log_det)
    return found


def judged_p(gain: float, terms: int, dof: int, looks: float) -> float:
    """Log probability that noise gains as much (twice the log likelihood) at any of so many looks."""
    return float(log_probability(np.array(gain), terms, dof)) + float(np.log(looks))


def degrees(effect: Effect, terms: int) -> int:
    """Degrees of freedom of an effect in the likelihood: one a coefficient that is not integrated out, at least one."""
    return terms - effect.drawn_of(terms) or 1


def refit(
    chain: Chain, free: Sequence[Free], like: Fit, *, iterations: int = 12, least_gain: float = SMALL_GAIN
) -> Fit:
    """Fit a chain's free parameters to the observations of another fit."""
    begun = evaluate(chain, tuple(free), like.observations, like.weighting)
    return solve_tidy(begun, iterations=iterations, least_gain=least_gain)


def solve_tidy(fit: Fit, *, iterations: int = 12, least_gain: float = SMALL_GAIN) -> Fit:
    """The fit at its optimum, phases and signs made tidy."""
    fit = solve(fit, iterations=iterations, least_gain=least_gain)
    return replace_chain(fit, tidy(fit.chain))


def replace_chain(fit: Fit, chain: Chain) -> Fit:
    """The fit with an equivalent chain (phases and signs made tidy)."""
    return held_anew(fit) if chain is fit.chain else evaluate(chain, fit.free, fit.observations, fit.weighting)


def settle(fit: Fit) -> tuple[Fit, Base]:
    """Let the fit take the noise that fits it best, the radius its own noise, and solve again."""
    fit = replace(fit, weighting=replace(fit.weighting, members=plausible_members(fit)))
    for _ in range(SETTLING):
        base = Base.of(fit)
        weighting = replace(fit.weighting, member=base.member, **_radius_setting(fit))
        same = weighting.member == fit.weighting.member and np.isclose(
            weighting.radius_weight, fit.weighting.radius_weight, rtol=0.05
        )
        if same and weighting.radius_member == fit.weighting.radius_member:
            return fit, base
        fit = solve(evaluate(fit.chain, fit.free, fit.observations, weighting))
    return fit, Base.of(fit)


def _radius_setting(fit: Fit) -> dict[str, Any]:
    """Noise member of the radius and its weight against the angle, each from its own residual."""
    if fit.observations.observables == 1:
        return {}
    family = fit.weighting.family
    angle = float(np.mean(fit.cosine_residual[0] ** 2 * family.weights[fit.weighting.member]))
    told = radius_noise(fit) if fit.weighting.radius_trusted else None
    member, radius = told if told is not None else radius_as_left(fit)
    # The channels' noise is as large along the radius as across it: the radius never counts for more than that.
    return {"radius_member": member, "radius_weight": min(angle / max(radius, 1e-300), 1.0)}


def radius_as_left(fit: Fit) -> tuple[int, float]:
    """Family member and variance that describe all that is left of the radius, as if it were noise."""
    family = fit.weighting.family
    squares = (fit.cosine_residual[1] ** 2) @ family.weights.T
    member = int(np.argmax(-0.5 * (fit.rows * np.log(np.maximum(squares, 1e-300)) + family.cost(fit.rows))))
    return member, float(squares[member] / len(fit.observations))


def add(fit: Fit, candidate: Candidate, *, iterations: int = 12, least_gain: float = SMALL_GAIN) -> tuple[Fit, str]:
    """The joint fit with the candidate added, and the key it got."""
    name = candidate.effect.name
    further = (f"{name}#{number}" for number in itertools.count(2))
    key = next(key for key in itertools.chain([name], further) if key not in fit.chain.values)
    chain = fit.chain.with_values({key: dict(candidate.effect.begin(candidate.values))})
    turns = int(fit.observations.motion.turn.max(initial=0)) + 1
    free = free_of(candidate.effect, key, turns=turns, channels=fit.observations.observables == 2)
    begun = evaluate(chain, free, fit.observations, fit.weighting)
    # A detail that this kind of the effect does not have.
    idle = {one for one, column in zip(free, begun.jacobian, strict=True) if not column.any()}
    free = tuple(one for one in free if one not in idle or candidate.effect.params[one.name].role != "shape")
    return refit(chain, (*fit.free, *free), fit, iterations=iterations, least_gain=least_gain), key


def reweighed(fit: Fit, member: int) -> Fit:
    """The fit as it stands, weighed by another family member."""
    return evaluate(fit.chain, fit.free, fit.observations, replace(fit.weighting, member=member))


def drop(fit: Fit, key: str) -> Fit:
    """The joint fit without this instance."""
    return solve_tidy(take_out(fit, key))


def take_out(fit: Fit, key: str) -> Fit:
    """The fit without this instance, all else left where it is: where a rival in its place is looked for.

    Fitted anew first, the other causes would bend to what the missing one did, some of them beyond return.
    """
    free = tuple(f for f in fit.free if f.key != key)
    return evaluate(fit.chain.without(key), free, fit.observations, fit.weighting)


@dataclass(frozen=True, eq=False)
class Trial:
    """A candidate fitted exactly: its joint fit, its key, and the noise that is plausible with it."""

    candidate: Candidate
    fit: Fit
    key: str
    members: tuple[int, ...]

    @classmethod
    def of(cls, fit: Fit, candidate: Candidate) -> Trial:
        """Add the candidate to the fit, with the noise that is left then: what it explains had passed for colour."""
        trial, key = add(fit, candidate)
        members = plausible_members(trial)
        found = _likelihoods(trial, members)
        member = max(found, key=lambda one: found[one])
        if member != trial.weighting.member:
            trial = solve_tidy(reweighed(trial, member))
        return cls(candidate, trial, key, members)

    def log_p(self, before: Fit, members: tuple[int, ...], dof: int) -> float:
        """Log probability that noise of these members gains as much."""
        gain = 2.0 * (likelihood(self.fit, members) - likelihood(before, members))
        terms = degrees(self.candidate.effect, self.candidate.terms)
        return judged_p(gain, terms, dof, self.candidate.looks)


def handicap(effect: Effect, fit: Fit) -> float:
    """What an effect has to gain beyond the others [nats]: without a name, or of the kind that stairs pass for."""
    settings = fit.settings
    stairs = settings.stairs_log_odds if fit.weighting.coarse and _aliased(effect, fit) else 0.0
    return stairs + effect.handicap + (settings.unnamed_log_odds if unnamed(effect.name) else 0.0)


def ends_at_bound(fit: Fit, key: str) -> bool:
    """Whether structure without a name is something else than it is called: its shape ends at a bound of what is."""
    effect, values = find(key, fit.chain.effects), fit.chain.values[key]
    inside = (effect.params[one].lower < values[one] < effect.params[one].upper for one in effect.fitted_shapes)
    return bool(effect.kind) and not all(inside)


def doubt_beside(fit: Fit, keys: Sequence[str]) -> float:
    """What a cause has to gain more [nats] beside a shape without a name.

    Such a shape describes something only nearly, and what it leaves may pass for a weak cause; unless the noise is
    coloured, which what it leaves is taken for.
    """
    nearly = fit.weighting.member == 0 and any(unnamed(key) for key in keys)
    return fit.settings.unnamed_log_odds if nearly else 0.0


def _aliased(effect: Effect, fit: Fit) -> bool:
    """Whether an effect has so many shapes, lines and places, that stairs' own pattern resembles one of them."""
    any_order = effect.line is not None or effect.comb is not None or "order" in effect.params or unnamed(effect.name)
    return any_order or len(effect.shapes(fit.linear.motion)) > fit.settings.aliased_shapes
