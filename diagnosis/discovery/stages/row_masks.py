"""Row masks: readings that stand alone far out of their neighbours are kept out of the fits."""

from __future__ import annotations

from diagnosis.discovery.marks.row_masks import mask_spikes
from diagnosis.discovery.state import State


def row_masks(state: State) -> State:
    """Mask single readings that stand out, fit anew, until their set is stable."""
    return state.with_(mask_spikes(state.fit, state.step, state.touched))
