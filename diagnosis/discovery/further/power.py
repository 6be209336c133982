"""What to measure next: how far a further measurement would part a cause from what explains the data as well.

Each entry of the menu is simulated with the cause, without noise, and the rival is fitted to it exactly with all else
that is free; and the other way round, for either may be true. What the wrong one leaves, whitened by the noise as it
was fitted, is the expected separation: its square is the mean of what the right one will gain over it (twice the log
likelihood).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from diagnosis.discovery.fitting.free_parameters import BASELINE, Free, free_of
from diagnosis.discovery.fitting.joint_fit import Fit, cost_of, evaluate, solve
from diagnosis.discovery.fitting.linearised_chain import Linear
from diagnosis.discovery.fitting.noise_family import noise_family
from diagnosis.discovery.fitting.subsample import stretches
from diagnosis.discovery.further.another_recording import Planned, planned
from diagnosis.discovery.further.measurements import MENU, Measurement
from diagnosis.discovery.settings import DiscoverySettings
from twin.catalogue import find
from twin.each_recording import everywhere
from twin.magnet.assembly import Assembly
from twin.motion import Motion

MOST_PLANNED = 4_000
"""Rows of a plan; a longer one is planned on a part of itself."""
_DEFAULTS = DiscoverySettings()
_ITERATIONS, _MOST_SOLVED, _STILL = 4, 8, 0.95
"""A rival is solved for in so many iterations at a time, until what it misses falls by less than a twentieth of it: the
noise that counts it is known no better from some hundred readings."""
_LEAST_SHARE = 0.01
"""A step that takes off less than this share of the squares ends them: four such ones are less than that twentieth."""
_LEAST_NOISE_RAD = 1e-12
_BASELINE_KEYS = {free.key for free in BASELINE}

_family = lru_cache(maxsize=2)(noise_family)
"""A plan is asked of several rivals one after the other."""


@dataclass(frozen=True)
class Option:
    """A further measurement: its name and plain words, its rank by cost, and by how many sigma it parts the rivals.

    ``sigma`` is that of the rival which is parted least, ``parted`` that of each by name; below three, it is no more
    than this.
    """

    name: str
    measurement: str
    sigma: float
    cost: int
    parted: Mapping[str, float] = field(default_factory=dict)


def options(fit: Fit, rivals: Mapping[str, Fit], menu: Sequence[Measurement] = MENU) -> tuple[Option, ...]:
    """What each measurement of the menu would part a fit's cause by from its rivals' fits; cheapest first."""
    if not rivals:
        return ()
    motion, found = fit.observations.motion, []
    # A long record is planned on a part of itself: the square of the separation grows with the readings.
    part = motion.part(stretches(motion, MOST_PLANNED)) if len(motion) > MOST_PLANNED else motion
    longer = float(np.sqrt(len(motion) / len(part)))
    for entry in sorted(menu, key=lambda entry: entry.cost):
        plan = entry.plan(part, fit.chain.magnet or Assembly())
        if plan is not None and any(_worth_it(fit, rival, entry) for rival in rivals.values()):
            parted: dict[str, float] = {}
            for name, rival in rivals.items():
                # The same effect in one recording and in another is one rival to whoever reads of it.
                sigma = longer * (_least_sigma(fit, rival, plan) if _worth_it(fit, rival, entry) else 0.0)
                parted[everywhere(name)] = min(sigma, parted.get(everywhere(name), sigma))
            found.append(Option(entry.name, entry.in_words(plan), min(parted.values()), entry.cost, parted))
    return tuple(found)


def _worth_it(fit: Fit, rival: Fit, entry: Measurement) -> bool:
    """Whether a further recording tells something of what the two do not share; else it is just a second sweep."""
    if entry.moved is None:
        return True
    own, others = (
        {free.key for free in one.free if entry.moved(find(free.key, one.chain.effects))} for one in (fit, rival)
    )
    return own != others


def _least_sigma(fit: Fit, rival: Fit, motion: Motion) -> float:
    """The separation from a rival, whichever of the two is true; what does not part them is not asked the other way."""
    sigma = separation_sigma(fit, rival, motion)
    return sigma if sigma < fit.settings.sigma_apart else min(sigma, separation_sigma(rival, fit, motion))


def best(offered: Sequence[Option], settings: DiscoverySettings = _DEFAULTS) -> Option | None:
    """The cheapest measurement that is enough, else the one that parts best; None where there is none."""
    enough = [option for option in offered if option.sigma >= settings.sigma_enough]
    if enough:
        return min(enough, key=lambda option: option.cost)
    return max(offered, key=lambda option: option.sigma, default=None)


def advice(offered: Sequence[Option], settings: DiscoverySettings = _DEFAULTS) -> str:
    """The best measurement in words, with the separation expected of it; several where no one parts all rivals."""
    option = best(offered, settings)
    if option is not None and option.sigma < settings.sigma_apart and len(option.parted) > 1:
        return "; ".join(_for_each(offered, settings))
    return _words(option, settings)


def _for_each(offered: Sequence[Option], settings: DiscoverySettings) -> Iterator[str]:
    """For each rival the measurement that parts it, rivals that the same one parts together."""
    rivals: dict[str, list[str]] = {}
    for name in offered[0].parted:
        own = [replace(option, sigma=option.parted[name], parted={}) for option in offered]
        rivals.setdefault(_words(best(own, settings), settings), []).append(name)
    for words, names in rivals.items():
        yield f"from {' and '.join(names)}: {words}"


def _words(option: Option | None, settings: DiscoverySettings) -> str:
    if option is None or option.sigma < settings.sigma_apart:
        reached = f" ({option.sigma:.1f} sigma at most)" if option is not None else ""
        return f"no further measurement of the menu parts them{reached}"
    if option.sigma < settings.sigma_enough:
        return f"{option.measurement} ({option.sigma:.1f} sigma, which may not be enough)"
    return f"{option.measurement} ({option.sigma:.0f} sigma)"


def separation_sigma(fit: Fit, rival: Fit, motion: Motion) -> float:
    """How many sigma of the noise the rival, at its best, would miss the planned readings by were ``fit`` true."""
    other = expected(fit, rival, motion)
    noise_rms = other.weighting.to_come_rad
    sigma = float(np.sqrt(other.squares_to_first_order)) / noise_rms
    if sigma <= fit.settings.sigma_apart:
        return sigma
    # What the rival cannot do to first order it may do exactly, and the other way round.
    missed = np.inf
    for _ in range(_MOST_SOLVED):
        before, other = missed, solve(other, iterations=_ITERATIONS, least_gain=_LEAST_SHARE * other.freedom)
        missed = float(np.sqrt(cost_of(other))) / noise_rms
        if missed > _STILL * before:
            break
    return missed


def expected(fit: Fit, rival: Fit, motion: Motion) -> Fit:
    """The rival, not yet fitted, on what a planned motion would read if the fit's chain were true."""
    truth, other = (planned(one, motion) for one in (fit, rival))
    channels, n = "vx" in motion.columns, len(motion)
    read = Linear(truth.chain, motion, blur=fit.weighting.blur, observables=2 if channels else 1)
    observations = replace(
        fit.observations,
        motion=motion,
        measured=read.angle,
        log_radius=read.log_radius if channels else None,
        usable=np.ones(n, dtype=bool),
        sure=np.ones(n, dtype=bool),
        scale=truth.level,
        level=truth.level,
        group=np.arange(n),
        ahead=np.zeros(n),
    )
    weight = fit.weighting.radius_weight if fit.observations.observables == 2 else 1.0
    weighting = replace(
        fit.weighting,
        family=_family(observations.lengths, fit.settings.colour_log_odds, members=fit.weighting.family.members),
        radius_member=fit.weighting.radius_member if fit.observations.observables == 2 else fit.weighting.member,
        radius_weight=weight if channels else 0.0,
        to_come_rad=max(float(np.sqrt(fit.variance)), _LEAST_NOISE_RAD) * truth.usual,
    )
    return evaluate(other.chain, _freed(rival, other, motion), observations, weighting)


def _freed(rival: Fit, there: Planned, motion: Motion) -> tuple[Free, ...]:
    """What the rival frees in the present readings, and the same in a further recording where that has it anew."""
    free: list[Free] = [one for one in rival.free if one in BASELINE]
    keys, turns = {one.key for one in rival.free}, int(motion.turn.max(initial=0)) + 1
    for key, source in there.source.items():
        if source in keys and key not in _BASELINE_KEYS:
            effect = find(key, there.chain.effects)
            free += free_of(effect, key, turns=turns, channels="vx" in motion.columns)
    return tuple(free)
