"""Free parameters: what a fit may move, where each stands, and between which bounds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from twin.angles import Array
from twin.baseline import FACTORS
from twin.catalogue import SameEffects, find
from twin.chain import Chain
from twin.effect import Effect
from twin.mechanics.zero import ZERO
from twin.param import Param


@dataclass(frozen=True)
class Free:
    """One free parameter: the instance it belongs to, its name, and the turn where it has one a turn."""

    key: str
    name: str
    turn: int | None = None


ZERO_ANGLE = Free(ZERO.name, "zero_deg")
BASELINE = (ZERO_ANGLE, *(Free(f.key, f.param) for f in FACTORS if f.effect is not ZERO))
"""The paper's error model, always fitted."""


def free_of(effect: Effect, key: str, *, turns: int, channels: bool) -> tuple[Free, ...]:
    """The parameters of an effect that a fit may move: strengths, phases, and shapes that are no whole numbers."""
    found: list[Free] = []
    for name, param in effect.params.items():
        if param.role in ("strength", "phase") or (
            param.role in ("level", "shape") and not param.counts and name in searched(effect, channels)
        ):
            found.append(Free(key, name))
        elif param.role == "per turn":
            found.extend(Free(key, name, turn) for turn in range(turns))
    return tuple(found)


def searched(effect: Effect, channels: bool) -> frozenset[str]:
    """Names of the shape and level parameters that a fit may move, with or without recorded channels."""
    names = {effect.line.param} if effect.line else set()
    return frozenset(names | set(effect.fitted_shapes) | (set(effect.channel_shapes) if channels else set()))


def from_centre(chain: Chain, free: tuple[Free, ...]) -> Array:
    """How far each free parameter (P,) is from what is most likely before the sweep, in its own unit; else 0."""
    away = np.zeros(len(free))
    for place, (one, (_, param)) in enumerate(zip(free, declared(chain, free), strict=True)):
        if one.turn is not None:
            away[place] = float(np.asarray(chain.values[one.key][one.name])[one.turn])
        elif param.prior_mean is not None:
            away[place] = value_in(chain, one, param) - param.prior_mean
    return away


def declared(chain: Chain, free: tuple[Free, ...]) -> tuple[tuple[Effect, Param], ...]:
    """The effect and the declaration of each free parameter."""
    return _declared(free, SameEffects(chain.effects))


@lru_cache(maxsize=64)
def _declared(free: tuple[Free, ...], same: SameEffects) -> tuple[tuple[Effect, Param], ...]:
    """The same: every step of a fit asks for them."""
    effects = [find(one.key, same.effects) for one in free]
    return tuple((effect, effect.params[one.name]) for one, effect in zip(free, effects, strict=True))


def value_of(chain: Chain, free: Free) -> float:
    """The value of a parameter in a chain, or its null where the chain does not give it."""
    return value_in(chain, free, find(free.key, chain.effects).params[free.name])


def value_in(chain: Chain, free: Free, param: Param) -> float:
    """The same where the declaration is at hand."""
    return float(chain.values.get(free.key, {}).get(free.name, param.null))


def bounds(effect: Effect, param: Param) -> tuple[float, float]:
    """Between which a parameter is fitted: an amplitude may pass through zero where a phase can turn by half a turn."""
    through_zero = param.role == "strength" and param.lower == 0.0 and bool(effect.roles("phase"))
    return (-param.upper if through_zero else param.lower), param.upper
