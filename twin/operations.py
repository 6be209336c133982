"""Effects as operations: each does something to one signal, and some do more to a signal behind it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

from twin.catalogue import STAGES, SameEffects, base_name, in_order
from twin.effect import Effect, Forward, Parameters
from twin.parameter_values import aligned

Acting = tuple[str, Effect, Parameters]
"""What acts on a signal: key, effect, complete parameters."""


def operations_of(effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    """All that effects do, one signal each, in chain order; what acts from farther ahead comes first in its stage."""
    return _in_order_of(SameEffects(effects))


@lru_cache(maxsize=16)
def _in_order_of(same: SameEffects) -> tuple[Effect, ...]:
    return in_order((*(one for effect in same.effects for one in effect.operations[1:]), *same.effects))


def acting(
    operations: Sequence[Effect], described: Sequence[Effect], given: Mapping[str, Parameters]
) -> Mapping[str, Sequence[Acting]]:
    """What acts on each signal, in order: described parts, each ahead of the effects of its stage, and given effects.

    Of those that are given the ones that are not at null.
    """
    present: dict[str, list[str]] = {}
    for key in sorted(given):
        present.setdefault(base_name(key), []).append(key)
    parts: dict[str, list[Effect]] = {}
    for part in described:
        parts.setdefault(part.acts_on, []).append(part)
    found: dict[str, list[Acting]] = {}
    for effect in operations:
        here, ahead = found.setdefault(effect.acts_on, []), parts.get(effect.acts_on, [])
        while ahead and STAGES.index(ahead[0].stage) <= STAGES.index(effect.stage):
            part = ahead.pop(0)
            here.append((part.name, part, {}))
        for key in present.get(effect.name, ()):
            values = {**effect.null(), **given[key]}
            if effect.acts(values):
                here.append((key, effect, {name: aligned(value, effect, name) for name, value in values.items()}))
    for acts_on, behind in parts.items():
        found.setdefault(acts_on, []).extend((part.name, part, {}) for part in behind)
    return found


def with_forwards(effect: Effect, made: Callable[[Effect], Forward]) -> Effect:
    """The effect with another forward function of each of its operations, made of that operation."""
    behind = effect.behind
    if behind is not None:
        behind = replace(behind, forward=made(effect.operations[1]))
    return replace(effect, forward=made(effect), behind=behind)
