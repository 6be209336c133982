"""Effects of single readings whose marks a test hands out: which rows, and how improbable by chance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.state import State
from twin.angles import Array
from twin.catalogue import find
from twin.effect import BoolArray, Effect, Marks
from twin.motion import Motion


def claiming(name: str, rows: tuple[int, ...], log_p: float, *, early: bool) -> Effect:
    """The named effect, which claims these rows with this log probability whatever the readings are."""

    def find_marks(
        measured: Array, residual: Array, noise: float, step: float, motion: Motion
    ) -> tuple[BoolArray, float]:
        return np.isin(np.arange(len(motion)), rows), log_p

    effect = find(name)
    assert effect.marks is not None
    return replace(effect, marks=Marks(find=find_marks, told=effect.marks.told, early=early))


def with_effects(state: State, *effects: Effect) -> State:
    """The state in which these are searched for and no others."""
    return state.with_(start=replace(state.start, effects=effects))
