"""What an object holds, in a form that can be compared: arrays by their bytes, generators by their state."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import cached_property
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.linearised_chain import Linear
from twin.effect import Effect


def _cached(thing: Any, name: str) -> bool:
    return isinstance(getattr(type(thing), name, None), cached_property)


_HELD: tuple[tuple[Any, Callable[[Any], Any]], ...] = (
    (Effect, lambda effect: effect.name),
    (np.ndarray, lambda array: (array.shape, str(array.dtype), array.tobytes())),
    (np.random.Generator, lambda generator: repr(generator.bit_generator.state)),
    (
        Linear,
        lambda linear: {name: content(value) for name, value in vars(linear).items() if not _cached(linear, name)},
    ),
    (Mapping, lambda mapping: {key: content(value) for key, value in mapping.items()}),
    ((list, tuple), lambda several: tuple(content(one) for one in several)),
)


def content(thing: Any) -> Any:
    """The fields of a dataclass and all they hold, but no cache beside them; effects by their names."""
    for kind, held in _HELD:
        if isinstance(thing, kind):
            return held(thing)
    if is_dataclass(thing):
        return type(thing).__name__, tuple(content(getattr(thing, one.name)) for one in fields(thing))
    return thing
