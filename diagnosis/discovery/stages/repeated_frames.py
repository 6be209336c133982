"""Repeated frames, and what else the values alone tell: such readings must not be searched for causes."""

from __future__ import annotations

from diagnosis.discovery.marks.row_masks import without_rows
from diagnosis.discovery.marks.sequence import touched_rows
from diagnosis.discovery.state import State
from twin.effect import Effect


def repeated_frames(state: State) -> State:
    """Find the readings whose marks can be told before the search (``Marks.early``), name the cause, and mask them.

    Asked again after the search: structure may hide them at first.
    """
    for effect in state.effects:
        if effect.marks is not None and effect.marks.early and not state.has(effect):
            after = claimed(state, effect)
            if after is not state:
                state = after.with_(without_rows(after.fit, after.touched))
    return state


def claimed(state: State, effect: Effect) -> State:
    """The state in which the effect has claimed the readings that bear its marks; the same where it is chance."""
    found = touched_rows(
        state.fit,
        state.sweep,
        effect,
        step=state.step,
        spoken_for=state.touched,
        family=state.family("sequence"),
    )
    if found is None:
        return state
    mask, cause = found
    return state.with_(touched=state.touched | mask, findings=(*state.findings, cause))
