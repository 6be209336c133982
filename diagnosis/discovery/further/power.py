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
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.coefficients import to_cosine
from diagnosis.discovery.fitting.joint_fit import BASELINE, Fit, Free, evaluate, free_of, solve
from diagnosis.discovery.fitting.linearised_chain import Linear
from diagnosis.discovery.fitting.noise_family import noise_family
from diagnosis.discovery.fitting.projection import projected
from diagnosis.discovery.fitting.subsample import stretches
from diagnosis.discovery.further.measurements import MENU, Measurement, Recording
from diagnosis.discovery.settings import DiscoverySettings
from twin.angles import Array
from twin.catalogue import find
from twin.chain import Chain
from twin.each_recording import everywhere

MOST_PLANNED = 4_000
"""Rows of a plan; a longer one is planned on a part of itself."""
_DEFAULTS = DiscoverySettings()
_ITERATIONS = 4

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
        planned = entry.plan(part)
        if planned is not None and any(_worth_it(fit, rival, planned) for rival in rivals.values()):
            parted: dict[str, float] = {}
            for name, rival in rivals.items():
                # The same effect in one recording and in another is one rival to whoever reads of it.
                sigma = longer * _least_sigma(fit, rival, planned)
                parted[everywhere(name)] = min(sigma, parted.get(everywhere(name), sigma))
            found.append(Option(entry.name, entry.words, min(parted.values()), entry.cost, parted))
    return tuple(found)


def _worth_it(fit: Fit, rival: Fit, planned: tuple[Recording, ...]) -> bool:
    """A further air gap tells something only of what changes with the field; else it is just a second sweep."""
    if len(planned) == 1:
        return True
    own, others = (
        {free.key for free in one.free if find(free.key, one.chain.effects).follow_field} for one in (fit, rival)
    )
    return own != others


def _least_sigma(fit: Fit, rival: Fit, planned: tuple[Recording, ...]) -> float:
    """The separation from a rival, whichever of the two is true; what does not part them is not asked the other way."""
    if not _worth_it(fit, rival, planned):
        return 0.0
    sigma = separation_sigma(fit, rival, planned)
    return sigma if sigma < fit.settings.sigma_apart else min(sigma, separation_sigma(rival, fit, planned))


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


def separation_sigma(fit: Fit, rival: Fit, planned: tuple[Recording, ...]) -> float:
    """How many sigma of the noise the rival, at its best, would miss the planned recordings by were ``fit`` true."""
    parts = [expected(fit, rival, recording) for recording in planned]
    sigma = _missed(parts, planned) / _noise_rms(fit)
    if len(parts) == 1 and sigma > fit.settings.sigma_apart:
        # What the rival cannot do to first order it may do exactly.
        sigma = min(sigma, _missed([solve(parts[0], iterations=_ITERATIONS)], planned) / _noise_rms(fit))
    return sigma


def _missed(parts: Sequence[Fit], planned: tuple[Recording, ...]) -> float:
    """Norm of the whitened residuals of all recordings, less all that the free parameters can do to first order."""
    residuals, jacobians = [], []
    for part, recording in zip(parts, planned, strict=True):
        r, j = part.whitened()
        scale = np.array([_at_field(free.key, free.name, part.chain, recording) for free in part.free])
        residuals.append(r)
        jacobians.append(j * scale[:, None])
    # Parameters are common to all recordings; only what belongs to the mounting is a second air gap's own.
    columns = [np.concatenate(jacobians, axis=1)]
    start = residuals[0].size
    for part in parts[1:]:
        mounting = _mounting(part)
        own = np.zeros((len(mounting), columns[0].shape[1]))
        own[:, start : start + mounting.shape[1]] = mounting
        columns.append(own)
        start += mounting.shape[1]
    left = projected(np.concatenate(residuals), np.concatenate(columns))
    return float(np.linalg.norm(left))


def _noise_rms(fit: Fit) -> float:
    """RMS [rad] of the fit's whitened residual."""
    return max(float(np.sqrt(fit.variance)), 1e-12)


def expected(fit: Fit, rival: Fit, recording: Recording) -> Fit:
    """The rival, not yet fitted, on what a planned recording would read if the fit's chain were true."""
    motion, n = recording.motion, len(recording.motion)
    turns = int(motion.turn.max(initial=0)) + 1
    truth, other = (_planned_chain(chain, recording, turns) for chain in (fit.chain, rival.chain))
    observables = 2 if recording.channels else 1
    read = Linear(truth, motion, blur=fit.weighting.blur, observables=observables)
    observations = replace(
        fit.observations,
        motion=motion,
        measured=read.angle,
        log_radius=read.log_radius if recording.channels else None,
        usable=np.ones(n, dtype=bool),
        sure=np.ones(n, dtype=bool),
        scale=np.ones(n),
        level=np.ones(n),
        group=np.arange(n),
        ahead=np.zeros(n),
    )
    weight = fit.weighting.radius_weight if fit.observations.observables == 2 else 1.0
    weighting = replace(
        fit.weighting,
        family=_family((n,), fit.settings.colour_log_odds),
        radius_member=fit.weighting.radius_member if fit.observations.observables == 2 else fit.weighting.member,
        radius_weight=weight if recording.channels else 0.0,
    )
    free: list[Free] = [one for one in rival.free if one in BASELINE]
    for key in dict.fromkeys(one.key for one in rival.free if one not in BASELINE):
        free += free_of(find(key, other.effects), key, turns=turns, channels=recording.channels)
    return evaluate(other, tuple(free), observations, weighting)


def _planned_chain(chain: Chain, recording: Recording, turns: int) -> Chain:
    """The chain at the recording's air gap, with a zero for each of its turns."""
    values: dict[str, dict[str, Any]] = {}
    for key, params in chain.values.items():
        effect = find(key, chain.effects)
        values[key] = dict(params)
        for name, value in params.items():
            if effect.params[name].role == "per turn":
                # Zeros of turns to come are draws like those seen: the same ones, the last first.
                values[key][name] = np.resize(np.concatenate([value, np.asarray(value)[::-1]]), turns)
            elif np.ndim(value) == 0:
                values[key][name] = value * _at_field(key, name, chain, recording)
    return replace(chain, values=values)


def _at_field(key: str, name: str, chain: Chain, recording: Recording) -> float:
    """Factor by which a parameter changes from the present air gap to the recording's.

    As its effect declares it, because a recording at one air gap cannot show it.
    """
    effect = find(key, chain.effects)
    values = {**effect.null(), **chain.values[key]}
    factor = effect.field_factor(name, values, field_ratio=recording.field, distance_ratio=recording.distance)
    return float(factor)


def _mounting(part: Fit) -> Array:
    """Whitened columns (q, N) of what comes anew with a second mounting: zero, offsets, gain and phase."""
    angle, n = part.linear.sensor_angle, len(part.observations)
    shapes = np.stack([np.ones(n), *(turned(k * angle) for k in (1, 2) for turned in (np.cos, np.sin))])
    columns = np.zeros((len(shapes), part.observations.observables, n))
    weight = np.sqrt(part.weighting.family.weights[part.weighting.member])
    columns[:, 0] = to_cosine(part.observations, shapes) * weight
    size = part.prior_residual.size
    return np.concatenate([columns.reshape(len(shapes), -1), np.zeros((len(shapes), size))], axis=1)
