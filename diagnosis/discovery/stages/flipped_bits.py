"""Flipped bits: single readings far out of everything known, told by the size of their errors."""

from __future__ import annotations

from diagnosis.discovery.stages.repeated_frames import claimed
from diagnosis.discovery.state import State


def flipped_bits(state: State) -> State:
    """Name what touches single readings without repeating them, judged on what the causes leave."""
    for effect in state.effects:
        if effect.marks is not None and not state.has(effect):
            state = claimed(state, effect)
    return state
