"""Additions: which cause, or which causes together, the joint fit gains most by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import SMALL_GAIN, Fit, evaluate, solve
from diagnosis.discovery.fitting.noise.plausible import either
from diagnosis.discovery.search.freed import in_detail
from diagnosis.discovery.search.likelihood_ratio import (
    Trial,
    degrees,
    ends_at_bound,
    handicap,
    judged_p,
    likelihood,
    settle,
    take_out,
)
from diagnosis.discovery.search.lines import lines_of, resolved
from diagnosis.discovery.search.parts import of_parts
from diagnosis.discovery.search.screening import Base, Candidate, screen, screen_one
from twin.catalogue import base_name, find, of_one_source, unnamed
from twin.effect import Effect

_AROUND_THE_SENSOR = ("mechanics", "reference")
"""Stages of what is mounted beside the sensor."""
_HIGHEST_SHARE = 0.9
"""Highest order looked at as a multiple, as a share of the points a turn."""


def candidates(
    base: Base, effects: Sequence[Effect], keys: Sequence[str], *, known: Candidate | None = None
) -> list[Candidate]:
    """Every effect that may still be added, at its best shape, best first after the handicap; one may be known."""
    present = {base_name(key) for key in keys}
    absent = [effect for effect in effects if effect.name not in present]
    found = [] if known is None else [known for effect in absent if effect is known.effect]
    sought = [form for effect in absent for form in (effect, *effect.sought_alone)]
    found += screen(base, [form for form in sought if not found or form is not found[0].effect])
    further = (one_more(base, effect, keys) for effect in effects if effect.name in present)
    found += [candidate for candidate in further if candidate is not None]
    found += multiples(base, effects, keys)
    held = [key for key in keys if key in base.fit.chain.values]
    taken = {order for own in lines_of(base.fit, held).values() for order in own}
    found = [one for one in found if not _where_a_line_is(one, base.fit, taken)]
    return sorted(found, key=lambda c: c.log_p + handicap(c.effect, base.fit))


def _where_a_line_is(candidate: Candidate, fit: Fit, taken: Set[int]) -> bool:
    """Whether a line without a name is at an order where the fit has one: both would stand against each other."""
    comb = candidate.effect.comb
    if comb is None or not unnamed(candidate.effect.name):
        return False
    return any(abs(one - order) <= resolved(fit) for one in comb.orders(candidate.values) for order in taken)


def may_come_again(effect: Effect) -> bool:
    """Whether an effect may be found once more beside itself; further lines of one source are looked for as such."""
    return effect.repeatable and not of_one_source(effect)


def one_more(base: Base, effect: Effect, keys: Sequence[str]) -> Candidate | None:
    """A further instance of an effect beside those among the keys: where there may be one, of another whole number."""
    if not may_come_again(effect):
        return None
    counted = [name for name in effect.roles("shape") if effect.params[name].counts]
    if not counted or effect.line is not None:
        return screen_one(base, effect)
    own = [base.fit.chain.values.get(key, {}) for key in keys if base_name(key) == effect.name]
    held = [[values.get(name) for name in counted] for values in own]
    shapes = effect.shapes(base.fit.linear.motion)
    return screen_one(base, effect, shapes=[one for one in shapes if [one.get(name) for name in counted] not in held])


def multiples(base: Base, effects: Sequence[Effect], keys: Sequence[str]) -> list[Candidate]:
    """The multiples at which a line that is in the fit already may show again, also where these alias.

    The one in the fit may be a multiple itself: then the line that it belongs to is looked for too.
    """
    found = []
    for effect in effects:
        if effect.line is None or not of_one_source(effect):
            continue
        motion = base.fit.observations.motion
        low, _ = effect.line.limits(motion)
        # Near the number of points a turn an order is a slow function of the row: no line is told from it.
        high = _HIGHEST_SHARE * motion.points_per_turn if effect.line.clock == "shaft" else np.inf
        for key in keys:
            if base_name(key) == effect.name:
                first = float(base.fit.chain.values[key][effect.line.param])
                times = np.array(effect.line.multiples, dtype=np.float64)
                # Ascending: of two that alias to one another the lower one is taken.
                values = np.sort(np.concatenate([first / times, first * times]))
                values = values[effect.line.within(values) & (values >= low) & (values < high)]
                candidate = screen_one(base, effect, shapes=[{effect.line.param: float(value)} for value in values])
                found += [candidate] if candidate is not None else []
    return found


@dataclass(frozen=True, eq=False)
class Step:
    """A joint fit with causes added: their keys with those effects that explain a fair part of what each does."""

    fit: Fit
    added: Mapping[str, Sequence[Effect]]
    terms: int
    log_looks: float


def best_addition(
    fit: Fit, base: Base, effects: Sequence[Effect], keys: Sequence[str], threshold: float
) -> Step | None:
    """The joint fit with the best significant candidate, contenders compared by exact fits; None if there is none."""
    ranked = [c for c in candidates(base, effects, keys) if c.log_p + handicap(c.effect, base.fit) < threshold]
    if not ranked:
        return None
    top = ranked[0].log_p + handicap(ranked[0].effect, fit)
    settings = fit.settings
    reach = max(settings.contender_nats, -settings.contender_share * top)
    near = [c for c in ranked if c.log_p + handicap(c.effect, base.fit) < top + reach][: settings.most_contenders]
    near += _asked_as_well(ranked, near, fit.settings.fair_share)
    trials = [Trial.of(fit, c) for c in near]
    trials += _in_the_place_of_a_shape(fit, ranked, near, threshold)
    # All are judged by the same noises: those that any of them leaves.
    members = either(*(t.members for t in trials))
    judged = [t.log_p(fit, members, base.dof) + handicap(t.candidate.effect, fit) for t in trials]
    # Fits end that near to their optima: of causes that do the same the last digits would choose. In doubt it is the
    # sensor's own.
    alike = [place for place, one in enumerate(judged) if one <= min(judged) + SMALL_GAIN]
    place = min(alike, key=lambda one: trials[one].candidate.effect.stage in _AROUND_THE_SENSOR)
    score = judged[place]
    if ends_at_bound(trials[place].fit, trials[place].key) or (score > threshold and of_parts(near[0].effect)):
        # Of lines that one cause joins first order may promise what the cause does not keep: they are asked alone.
        tried = trials[place].candidate.effect if score <= threshold else near[0].effect
        return best_addition(fit, base, [one for one in effects if one.name != tried.name], keys, threshold)
    if score > threshold:
        return None
    trial, chosen = trials[place], trials[place].candidate
    fair = {c.effect.name for c in ranked if c.gain > fit.settings.fair_share * chosen.gain}
    return Step(
        trial.fit,
        {trial.key: [effect for effect in effects if effect.name in fair]},
        degrees(chosen.effect, chosen.terms),
        float(np.log(chosen.looks)) + handicap(chosen.effect, fit),
    )


def _asked_as_well(ranked: Sequence[Candidate], near: Sequence[Candidate], share: float) -> list[Candidate]:
    """Candidates that first order may undervalue, beside those that it puts first.

    Where a cause that joins several parts is first, for its many coefficients promise much, the best other one; and the
    best level that explains a fair share, as its change is the farther from what it is in the end the larger it is.
    """
    rest = ranked[len(near) :]
    other = [c for c in rest if not of_parts(c.effect)][: 1 if of_parts(near[0].effect) else 0]
    level = [c for c in rest if c.effect.whole and c not in other and c.gain > share * near[0].gain][:1]
    return [*other, *level]


def _in_the_place_of_a_shape(
    fit: Fit, ranked: Sequence[Candidate], near: Sequence[Candidate], threshold: float
) -> list[Trial]:
    """Where a shape without a name is among the nearest: the named candidates with those of their details that pay.

    A cause whose details are at their nulls may leave so much that a shape, which has none, comes first.
    """
    gains = [one.gain for one in near if unnamed(one.effect.name)]
    if not gains:
        return []
    least = fit.settings.rival_share * max(gains)
    provides = fit.observations.motion.provides
    detailed = (one for one in ranked if one.gain > least and one.effect.details(provides))
    named = (one for one in detailed if not unnamed(one.effect.name))
    return [one for candidate in named if (one := in_detail(Trial.of(fit, candidate), threshold)) is not None]


def best_together(
    fit: Fit, base: Base, effects: Sequence[Effect], keys: Sequence[str], threshold: float
) -> Step | None:
    """One to three causes that together explain what none of them does alone; None if there are none.

    One, where the weights of coloured noise lead its fit astray. Several, because what they leave passes for coloured
    noise to each of them: so they are looked for as if the noise were white, one after the other, and then judged
    together with the noise free to be what it is. That there are many such sets to choose from is paid for.
    """
    if base.member == 0:
        return None
    family = fit.weighting.family
    only_white = family.white_alone()
    weighting = replace(fit.weighting, family=only_white, member=0, members=(), radius_member=0)
    trial, white = settle(solve(evaluate(fit.chain, fit.free, fit.observations, weighting)))
    added: dict[str, Sequence[Effect]] = {}
    terms, log_looks = 0, 0.0
    for depth in range(fit.settings.most_together):
        step = best_addition(trial, white, effects, [*keys, *added], threshold)
        if step is None:
            return None
        added.update(step.added)
        terms, log_looks = terms + step.terms, log_looks + step.log_looks
        trial, white = settle(retuned(step.fit, keys))
        # White at first: by another weight it might be led astray again.
        joint, _ = settle(solve(evaluate(trial.chain, trial.free, fit.observations, replace(fit.weighting, member=0))))
        members = either(fit.weighting.plausible, joint.weighting.plausible)
        gain = 2.0 * (likelihood(joint, members) - likelihood(fit, members))
        choices = depth * float(np.log(max(len(effects), 1)))
        if judged_p(gain, terms, base.dof, 1.0) + log_looks + choices < threshold:
            return Step(joint, added, terms, log_looks)
    return None


def retuned(fit: Fit, keys: Sequence[str]) -> Fit:
    """The fit with each stuck bit among the keys found afresh, where that fits better.

    Its edges are so narrow that a weight found before the rest was known holds on to the wrong ones.
    """
    for key in keys:
        effect = find(key, fit.chain.effects)
        if effect.line is None or effect.line.clock != "channels":
            continue
        removed = take_out(fit, key)
        again = screen_one(Base.of(removed), effect)
        if again is None:
            continue
        trial = Trial.of(removed, again)
        if likelihood(trial.fit, fit.weighting.plausible) > likelihood(fit) + fit.settings.swap_log_odds:
            fit = trial.fit
    return fit
