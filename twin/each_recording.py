"""Effects over several recordings of one device: each recording by itself, with what follows its air gap.

The device's parameters are common to all recordings. An effect acts on each of them as on a sweep of its own: what it
remembers begins anew, and what follows the magnet's field or distance is that of the recording's air gap.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from twin.angles import Array
from twin.chain import Chain
from twin.effect import Effect, Forward, Parameters
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.mechanics.zero import ZERO
from twin.motion import Motion
from twin.operations import with_forwards
from twin.recordings import Setup

MARK = "@"
"""Stands between an effect's name and the number of the recording (from 1) that alone it acts in."""


@dataclass(frozen=True, eq=False)
class InEach:
    """The forward function of an effect, applied to each recording by itself: ``forwards`` are those at its air gap."""

    effect: Effect
    forwards: tuple[Forward, ...]

    def __call__(self, signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        if motion.recordings is None:
            return self.effect.forward(signal, motion, values, rng)
        found = [
            forward(signal[..., rows], part, in_setup(self.effect, values, setup), rng)
            for forward, rows, part, setup in zip(
                self.forwards, motion.recordings.slices, motion.parts, motion.recordings.setups, strict=True
            )
        ]
        return np.concatenate(found, axis=-1)


@dataclass(frozen=True, eq=False)
class InOne:
    """The forward function of an effect that acts in one recording alone; ``number`` counts them from 0."""

    effect: Effect
    number: int

    def __call__(self, signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        if motion.recordings is None:
            return signal
        rows = motion.recordings.slices[self.number]
        moved = self.effect.forward(signal[..., rows], motion.parts[self.number], values, rng)
        out = np.empty((*moved.shape[:-1], signal.shape[-1]))
        out[...] = signal
        out[..., rows] = moved
        return out


def over_recordings(effects: Iterable[Effect], setups: Sequence[Setup], magnet: Magnet) -> tuple[Effect, ...]:
    """The effects over recordings of a device: common to all of them, or one for each where it is the recording's own.

    ``magnet`` is the one whose air gaps the setups state.
    """
    found: list[Effect] = []
    for effect in effects:
        if effect.name == ZERO.name:
            found += [effect, *(in_one(effect, number) for number in range(1, len(setups)))]
        elif belongs_to_recording(effect):
            found += [in_one(effect, number) for number in range(len(setups))]
        else:
            found.append(in_each(effect, setups, magnet))
    return tuple(found)


def belongs_to_recording(effect: Effect) -> bool:
    """Whether an effect in the mean has parameters of the recording's; zeros of turns are their recording's already."""
    own = any(effect.owner(name) == "recording" for name in effect.params)
    return own and effect.footprint == "mean" and not effect.roles("per turn")


def in_each(effect: Effect, setups: Sequence[Setup], magnet: Magnet) -> Effect:
    """The effect with parameters common to all recordings of a device, whose air gaps are those of this magnet.

    Zeros of single turns stay as they are: each belongs to its turn, and so to its recording, already.
    """
    if effect.roles("per turn"):
        return effect
    return with_forwards(effect, lambda one: InEach(one, tuple(_at_gap(one, magnet, setup) for setup in setups)))


def in_one(effect: Effect, number: int) -> Effect:
    """The effect in one recording alone (counted from 0), with parameters of that recording's own."""
    line = effect.line
    return replace(
        with_forwards(effect, lambda one: InOne(one, number)),
        name=f"{effect.name}{MARK}{number + 1}",
        shapes=_of_part(effect.shapes, number),
        line=None if line is None else replace(line, limits=_of_part(line.limits, number)),
    )


def acts_in(name: str) -> int | None:
    """The recording (counted from 0) that alone an effect of this name or key acts in; None: it acts in all."""
    _, mark, number = name.split("#", 1)[0].partition(MARK)
    return int(number) - 1 if mark else None


def everywhere(name: str) -> str:
    """The name of the effect of which one of this name acts in one recording alone; else the name itself."""
    return name.partition(MARK)[0]


def of_device(effect: Effect) -> Effect:
    """The effect as it acts in a single recording."""
    return effect.forward.effect if isinstance(effect.forward, InEach | InOne) else effect


def device_of(chain: Chain) -> Chain:
    """The device's twin by itself: without what belongs to single recordings, as mounted in the first one."""
    if not any(isinstance(effect.forward, InEach) for effect in chain.effects):
        return chain
    own = [key for key in chain.values if acts_in(key) is not None]
    effects = {effect.name: effect for effect in map(of_device, chain.effects)}
    return replace(chain.without(*own), effects=tuple(effects.values()))


def in_setup(effect: Effect, values: Parameters, setup: Setup) -> Parameters:
    """The parameters as they are at the recording's field and distance."""
    if setup.field == 1.0 and setup.distance == 1.0:
        return values
    following = [name for name in effect.follow_field if name in values]
    return {**values, **effect.in_field(values, following, field_ratio=setup.field, distance_ratio=setup.distance)}


def _at_gap(effect: Effect, magnet: Magnet, setup: Setup) -> Forward:
    """The forward function of an effect in the field of the magnet at the recording's air gap."""
    if effect.at_magnet is None or setup.air_gap_mm is None:
        return effect.forward
    return effect.at_magnet(Assembly(magnet, Placement(air_gap_mm=setup.air_gap_mm))).forward


def _of_part(function: Callable[[Motion], Any], number: int) -> Callable[[Motion], Any]:
    return lambda motion: function(motion if motion.recordings is None else motion.parts[number])
