"""Rivals: what a cause gains in the final fit, and which other causes would explain the same readings as well."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from diagnosis.discovery.fitting.free_parameters import declared
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.usual_factors import with_usual_factors
from diagnosis.discovery.search.forward_step import may_come_again, one_more
from diagnosis.discovery.search.likelihood_ratio import TO_THE_END, add, likelihood, likelihood_of_readings
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.search.screening import screen_one
from twin.catalogue import base_name, unnamed
from twin.effect import Effect

ROUGH_GAIN = 0.1
"""Gain in chi-square of a step below which a rival's first fit ends: most rivals are far from as good as a cause."""
LEFT_OFF = 4.0
"""What such a fit may still gain: in a curved valley each step gains a little less than the one before."""


@dataclass(frozen=True, eq=False)
class Judged:
    """A cause of the joint fit: its instance key, what it gains (twice the log likelihood), the log probability by
    chance, and by name the fits with another effect in its place that would do as well."""

    key: str
    gain: float
    log_p: float
    rivals: Mapping[str, Fit] = field(default_factory=dict)


def judge(fit: Fit, key: str, effects: Sequence[Effect], keys: Sequence[str]) -> Judged:
    """What a cause gains in the final fit, and which named effects (of these) would fit as well.

    Among them are those that an angle alone never names: here they do what it shows beside the baseline.
    """
    removal = Removal.of(fit, key)
    rivals: dict[str, Fit] = {}
    if not unnamed(removal.effect.name):
        # What is there already may come again, with another whole number.
        again = {effect.name for effect in effects if may_come_again(effect)}
        present = {*(base_name(other) for other in keys if base_name(other) not in again), removal.effect.name}
        provides = fit.observations.motion.provides
        others = [other for other in effects if other.name not in present and not unnamed(other.name)]
        rivals = _as_good(fit, removal, [other for other in others if other.visible_in(provides)])
        if hidden := [other for other in others if other.acts_in(provides) and not other.visible_in(provides)]:
            # Beside the factors that do the same they fit anything, at sizes of these that no device has.
            usual = with_usual_factors(fit)
            found = _as_good(usual, Removal.of(usual, key), hidden)
            rivals |= {name: rival for name, rival in found.items() if _reads_as_well(rival, fit)}
    return Judged(key, removal.gain, removal.log_p, rivals)


def _as_good(fit: Fit, removal: Removal, others: Sequence[Effect]) -> dict[str, Fit]:
    """By name the fits with one of these in the place of a cause that cannot be told from the fit with the cause."""
    found = {}
    for other in others:
        rival = next(filter(None, (_in_its_place(fit, removal, form) for form in forms(other))), None)
        if rival is not None:
            found[other.name] = rival
    return found


def _reads_as_well(rival: Fit, fit: Fit) -> bool:
    """Whether a rival fits the readings themselves as well, and not only makes the factors more usual."""
    same = fit.settings.same_fit(coarse=fit.weighting.coarse)
    return 2.0 * (likelihood_of_readings(fit) - likelihood_of_readings(rival)) < same


def forms(effect: Effect) -> Iterator[Effect]:
    """What an effect may be to a cause that it cannot be told from, the plainest first.

    A detail that no search sets, because another effect says it more plainly, is a rival of that one alone.
    """
    for names in effect.stand_aside:
        yield effect.alone(*names)
    yield effect


def _in_its_place(fit: Fit, removal: Removal, other: Effect) -> Fit | None:
    """The fit with another effect in the place of a cause, if it cannot be told from the fit with the cause."""
    settings, gain, own = fit.settings, removal.gain, removal.own
    same = settings.same_fit(coarse=fit.weighting.coarse)
    there = [key for key in removal.removed.chain.values if base_name(key) == other.name]
    rival = one_more(removal.base, other, there) if there else screen_one(removal.base, other)
    if rival is None or rival.gain < settings.rival_share * min(gain, own.gain if own is not None else gain) - same:
        return None
    # A step between two turns is a special case of a zero for each turn: what fits counts, not its price.
    least = rival.gain if other.roles("per turn") else -np.inf

    def gained(trial: Fit) -> float:
        return max(2.0 * (likelihood(trial) - likelihood(removal.without)), least)

    fitted = partial(add, removal.removed, rival, iterations=TO_THE_END)
    trial, _ = fitted(least_gain=ROUGH_GAIN)
    if gained(trial) <= gain - _same(fit, trial) - LEFT_OFF:
        return None
    # From the beginning: begun anew in a curved valley, a fit may end where it stands.
    trial, _ = fitted()
    return trial if gained(trial) > gain - _same(fit, trial) else None


def _same(fit: Fit, rival: Fit) -> float:
    """By how much twice the log likelihood of two fits may differ that cannot be told apart.

    Each shape that a prior alone holds, and the rival has not, may follow the noise: with all of them the difference is
    as improbable by chance as the usual one is with a single parameter.
    """
    from scipy.special import chdtrc, chdtri

    usual = fit.settings.same_fit(coarse=fit.weighting.coarse)
    more = max(_held_shapes(fit) - _held_shapes(rival), 0)
    return float(chdtri(1 + more, chdtrc(1, usual))) if more else usual


def _held_shapes(fit: Fit) -> int:
    """How many of the free shapes have a prior."""
    return sum(param.role == "shape" and param.prior_sd > 0.0 for _, param in declared(fit.chain, fit.free))
