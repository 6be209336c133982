"""What a kind of physics is: how its sizes are drawn, which motion shows it, which answers are right."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..baseline import Setting
from ..motion import NO_DEMANDS, Demands, Motion
from ..protocols import PROTOCOLS
from .device import Mechanism

ALL = tuple(PROTOCOLS)
STOPPED = ("static", "static_both", "many_turns")
BOTH_WAYS = ("static_both", "oven_both")
FAST = ("speeds", "speeds_one_way")
OVEN = ("oven", "oven_both")


@dataclass(frozen=True)
class Planned:
    """A mechanism with all its sizes settled."""

    mechanism: Mechanism
    size_deg: float = 0.0
    """Roughly what it does to the angle."""
    parameters: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """By cause and public name, where the answer's parameter has a defined meaning."""


Plan = Callable[[np.random.Generator, Setting], Planned]


@dataclass(frozen=True)
class Kind:
    """One kind of physics."""

    plan: Plan
    answers: tuple[tuple[str, ...], ...] = ((),)
    """Lists of names, each of which is right."""
    tolerated: tuple[str, ...] = ()
    """Names that may be given or left out."""
    protocols: tuple[str, ...] = ALL
    demands: Demands = NO_DEMANDS
    channels: bool | None = None
    """Whether vx, vy are recorded; drawn where None."""
    outcome_repeats: bool = True
    """What happened in one recording happens in the next, so that its twin can predict that."""
    noise_bits: int = 16
    """Bits of the angle word."""
    own_motion: Callable[[np.random.Generator], Motion] | None = None
    """A motion that no protocol of the bench drives."""
    noisy: bool = False
    """The noise is what is special: there is no mean to stand clear of it."""
