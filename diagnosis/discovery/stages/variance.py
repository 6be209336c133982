"""Variance: rows that are much louder than others weigh less, before the search takes their noise for structure."""

from __future__ import annotations

from diagnosis.discovery.marks.row_masks import scaled
from diagnosis.discovery.marks.spread import bursts, spread_shapes
from diagnosis.discovery.state import State


def variance(state: State) -> State:
    """Weigh the rows by a stretch or a shape of louder noise that is beyond doubt.

    Nothing is named yet: structure that is still unknown passes for uneven noise, the less so the smoother it is. Once
    a search has been made, the spread of what it leaves is judged instead
    (:func:`~diagnosis.discovery.stages.spread.spread`).
    """
    several = state.fit.observations.motion.recordings is not None
    if state.looked_at or several:
        # What common factors leave in one of several recordings is loud, and is what tells the causes from each other.
        return state
    fit, limit = state.fit, state.settings.beyond_doubt_log_p
    rough = bursts(fit, against_neighbours=True)
    # Its ends are told by how far off the rows are; that they are not off together, by their neighbours.
    burst = bursts(fit) if rough is not None and rough.log_p < limit else None
    # A shape by the speed is louder in one stretch too, where the shaft was fastest.
    found = [*spread_shapes(fit, state.effects), *([burst] if burst is not None else [])]
    louder = min(found, key=lambda one: one.log_p, default=None)
    if louder is None or louder.log_p >= limit:
        return state
    return state.with_(scaled(fit, louder.variance))
