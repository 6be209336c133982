"""Rivals: what a cause gains in the final fit, and which other causes would explain the same readings as well."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.search.likelihood_ratio import add, likelihood
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.search.screening import screen_one
from twin.catalogue import base_name, unnamed
from twin.effect import Effect


@dataclass(frozen=True, eq=False)
class Judged:
    """A cause of the joint fit: its instance key, what it gains (twice the log likelihood), the log probability by
    chance, and by name the fits with another effect in its place that would do as well."""

    key: str
    gain: float
    log_p: float
    rivals: Mapping[str, Fit] = field(default_factory=dict)


def judge(fit: Fit, key: str, effects: Sequence[Effect], keys: Sequence[str]) -> Judged:
    """What a cause gains in the final fit, and which named effects (of these, all visible) would fit as well."""
    removal = Removal.of(fit, key)
    rivals: dict[str, Fit] = {}
    if not unnamed(removal.effect.name):
        present = {*(base_name(other) for other in keys), removal.effect.name}
        for other in effects:
            if other.name not in present and not unnamed(other.name):
                rival = _as_good(fit, removal, other)
                if rival is not None:
                    rivals[other.name] = rival
    return Judged(key, removal.gain, removal.log_p, rivals)


def _as_good(fit: Fit, removal: Removal, other: Effect) -> Fit | None:
    """The fit with another effect in the place of a cause, if it cannot be told from the fit with the cause."""
    settings, gain, own = fit.settings, removal.gain, removal.own
    same = settings.same_fit(coarse=fit.weighting.coarse)
    rival = screen_one(removal.base, other)
    if rival is None or rival.gain < settings.rival_share * min(gain, own.gain if own is not None else gain) - same:
        return None
    trial, _ = add(removal.removed, rival)
    rival_gain = 2.0 * (likelihood(trial) - likelihood(removal.without))
    if other.roles("per turn"):
        # A step between two turns is a special case of a zero for each turn: what fits counts, not its price.
        rival_gain = max(rival_gain, rival.gain)
    return trial if rival_gain > gain - same else None
