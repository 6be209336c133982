"""Flipped bits: single readings far out of everything known, told by the size of their errors."""

from __future__ import annotations

from diagnosis.discovery.marks.sequence import touched_rows
from diagnosis.discovery.state import State


def flipped_bits(state: State) -> State:
    """Name what touches single readings without repeating them, judged on what the causes leave."""
    for effect in state.effects:
        if effect.marks is None or state.has(effect):
            continue
        found = touched_rows(
            state.fit,
            state.sweep,
            effect,
            step=state.step,
            spoken_for=state.touched,
            family=state.family("sequence"),
        )
        if found is not None:
            mask, cause = found
            state = state.with_(touched=state.touched | mask, findings=(*state.findings, cause))
    return state
