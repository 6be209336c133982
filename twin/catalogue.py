"""Every effect of the twin, in the order in which the signal meets them."""

from __future__ import annotations

import copyreg
import pickle
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from twin import adc, concentrator, cordic, empirical, hall, link, magnet, mechanics, reference
from twin.effect import Effect
from twin.known_names import nearest

STAGES = ("mechanics", "magnet", "concentrator", "hall", "adc", "cordic", "empirical", "link", "reference")
ACTS_ON = ("shaft", "field", "channels", "angle", "word", "reference")

_DECLARED: tuple[Effect, ...] = (
    *mechanics.EFFECTS,
    *magnet.EFFECTS,
    *concentrator.EFFECTS,
    *hall.EFFECTS,
    *adc.EFFECTS,
    *cordic.EFFECTS,
    *empirical.EFFECTS,
    *link.EFFECTS,
    *reference.EFFECTS,
)


def in_order(effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    """Effects in chain order: by the signal they act on, then by stage, then as declared."""
    return tuple(sorted(effects, key=lambda e: (ACTS_ON.index(e.acts_on), STAGES.index(e.stage))))


CATALOGUE: tuple[Effect, ...] = in_order(_DECLARED)


def at_magnet(effects: tuple[Effect, ...], magnet: Any) -> tuple[Effect, ...]:
    """The effects with those that act through the magnet's field in the field of a described one (an ``Assembly``)."""
    return tuple(effect if effect.at_magnet is None else effect.at_magnet(magnet) for effect in effects)


def base_name(key: str) -> str:
    """The name of the effect that an instance key belongs to: ``drive_ripple#2`` is a second ``drive_ripple``."""
    return key.split("#", 1)[0]


def unnamed(key: str) -> bool:
    """Whether an instance key belongs to an empirical shape: structure that has no cause's name."""
    return base_name(key).startswith("unnamed")


def found_together(effect: Effect) -> bool:
    """Whether an effect is known only by several lines together, which are found one by one as those of others."""
    return effect.comb is not None and effect.comb.unite is not None


def of_one_source(effect: Effect) -> bool:
    """Whether further lines of an effect are the multiples of its first one or what that is a multiple of, or are known
    for its own only together."""
    return found_together(effect) or (effect.line is not None and bool(effect.line.multiples))


def output_grid(effects: Iterable[Effect] = CATALOGUE) -> Effect | None:
    """The effect whose attainable angles are the grid of the output word; None where there is none."""
    return next((effect for effect in effects if effect.output_grid), None)


def find(key: str, effects: tuple[Effect, ...] = CATALOGUE) -> Effect:
    """The effect with this name or instance key.

    Raises KeyError with the known names where there is none.
    """
    name = base_name(key)
    named = _by_name(SameEffects(effects))
    if name not in named:
        known = sorted(named)
        raise KeyError(f"no effect named '{name}'{nearest(name, known)}; known: {', '.join(known)}")
    return named[name]


@dataclass(frozen=True, eq=False)
class SameEffects:
    """Effects that are told from others by being the same object: a fit asks for them a million times."""

    effects: tuple[Effect, ...]

    def __hash__(self) -> int:
        return id(self.effects)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SameEffects) and other.effects is self.effects


@lru_cache(maxsize=16)
def _by_name(same: SameEffects) -> Mapping[str, Effect]:
    return {effect.name: effect for effect in reversed(same.effects)}


def _pickled(effect: Effect) -> str | tuple[Any, ...]:
    """An effect of the catalogue by its name, since some of its functions cannot be pickled; others as they are."""
    if any(effect is known for known in CATALOGUE):
        return find, (effect.name,)
    return effect.__reduce_ex__(pickle.HIGHEST_PROTOCOL)


copyreg.pickle(Effect, _pickled)
