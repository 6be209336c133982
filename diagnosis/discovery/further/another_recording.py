"""A fitted chain in the readings that a plan asks for: with more turns, and in further recordings of the device."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from twin.angles import Array
from twin.catalogue import base_name, find
from twin.chain import Chain
from twin.each_recording import MARK, acts_in, belongs_to_recording, of_device, over_recordings
from twin.effect import Effect
from twin.hall.noise import NOISE
from twin.magnet.assembly import Assembly
from twin.mechanics.zero import ZERO
from twin.motion import Motion
from twin.recordings import Setup


@dataclass(frozen=True, eq=False)
class Planned:
    """A chain on a planned motion.

    ``source`` names for each key of the chain the key of the fitted one that it comes from; ``level`` (n,) is the noise
    of each row's recording against the usual one, the median, and ``usual`` that against the fitted readings' own.
    """

    chain: Chain
    source: Mapping[str, str]
    level: Array
    usual: float = 1.0


def planned(fit: Fit, motion: Motion) -> Planned:
    """A fit's chain on a planned motion, whose last recordings may be further ones than the fit has seen.

    A further recording repeats the first one: it has the same noise in volts, and what belongs to a recording alone is
    in it as in the first; its zero is turned with the sensor.
    """
    turns = int(motion.turn.max(initial=0)) + 1
    recordings = fit.observations.motion.recordings
    known = 1 if recordings is None else len(recordings)
    if motion.recordings is None:
        return Planned(_with_turns(fit.chain, turns), {key: key for key in fit.chain.values}, np.ones(len(motion)))
    setups = motion.recordings.setups
    effects = {effect.name: effect for effect in map(of_device, fit.chain.effects)}
    values: dict[str, Mapping[str, Any]] = {}
    source: dict[str, str] = {}
    for key, params in fit.chain.values.items():
        for own, moved in _in_recordings(key, params, effects[_device_name(key)], setups, known):
            values[own], source[own] = moved, key
    magnet = (fit.chain.magnet or Assembly()).magnet
    chain = replace(fit.chain, values=values, effects=over_recordings(effects.values(), setups, magnet))
    level = _levels(fit, setups)[motion.recordings.number]
    usual = float(np.median(level))
    return Planned(_with_turns(chain, turns), source, level / usual, usual)


def _device_name(key: str) -> str:
    return base_name(key).partition(MARK)[0]


def _in_recordings(
    key: str, params: Mapping[str, Any], effect: Effect, setups: tuple[Setup, ...], known: int
) -> list[tuple[str, Mapping[str, Any]]]:
    """An instance of an effect by its keys over all recordings, of which so many are known already."""
    place, (name, mark, number) = acts_in(key), key.partition("#")
    name, further = name.partition(MARK)[0], range(known, len(setups))

    def of(recording: int) -> str:
        return f"{name}{MARK}{recording + 1}{mark}{number}"

    if effect.name == ZERO.name:
        if place is not None:
            return [(key, params)]
        # A sensor that is turned with the angles it counts sees the field stand back by as much, beside the first zero.
        zeros = [{"zero_deg": setups[0].turned_deg - setups[one].turned_deg} for one in further]
        return [(key, params), *zip(map(of, further), zeros, strict=True)]
    if not belongs_to_recording(effect):
        return [(key, params)]
    if place is None:
        return [(of(one), params) for one in range(len(setups))]
    return [(key, params), *((of(one), params) for one in further if place == 0)]


def _with_turns(chain: Chain, turns: int) -> Chain:
    """The chain with a zero for each of so many turns: those to come are draws like those seen, the last first."""
    values = {key: dict(params) for key, params in chain.values.items()}
    for key, params in values.items():
        for name in find(key, chain.effects).roles("per turn"):
            if name in params:
                seen = np.asarray(params[name])
                params[name] = np.resize(np.concatenate([seen, seen[::-1]]), turns)
    return replace(chain, values=values)


def _levels(fit: Fit, setups: tuple[Setup, ...]) -> Array:
    """Noise of each recording against the fitted readings', as they show it, or as it grows in a weaker field."""
    recordings = fit.observations.motion.recordings
    first = [0] if recordings is None else [rows.start for rows in recordings.slices]
    seen = fit.observations.level[first].tolist()
    weaker = (
        NOISE.field_factor("rms_deg", NOISE.null(), field_ratio=one.field / setups[0].field, distance_ratio=1.0)
        for one in setups[len(seen) :]
    )
    return np.array([*seen, *(seen[0] * float(factor) for factor in weaker)])
