"""Repeated frames, and what else the values alone tell: such readings must not be searched for causes."""

from __future__ import annotations

from diagnosis.discovery.marks.row_masks import without_rows
from diagnosis.discovery.marks.sequence import touched_rows
from diagnosis.discovery.state import State


def repeated_frames(state: State) -> State:
    """Find the readings whose marks can be told before the search (``Marks.early``), name the cause, and mask them.

    Asked again after the search: structure may hide them at first.
    """
    for effect in state.effects:
        if effect.marks is None or not effect.marks.early or state.has(effect):
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
            touched = state.touched | mask
            fit = without_rows(state.fit, touched)
            state = state.with_(fit, touched=touched, findings=(*state.findings, cause))
    return state
