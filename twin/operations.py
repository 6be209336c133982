"""Effects as operations: each does something to one signal, and some do more to a signal behind it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from twin.catalogue import in_order
from twin.effect import Effect, Forward


def operations_of(effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    """All that effects do, one signal each, in chain order; what acts from farther ahead comes first in its stage."""
    return in_order((*(one for effect in effects for one in effect.operations[1:]), *effects))


def with_forwards(effect: Effect, made: Callable[[Effect], Forward]) -> Effect:
    """The effect with another forward function of each of its operations, made of that operation."""
    behind = effect.behind
    if behind is not None:
        behind = replace(behind, forward=made(effect.operations[1]))
    return replace(effect, forward=made(effect), behind=behind)
