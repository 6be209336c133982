"""Stepwise: causes are added, exchanged and removed until nothing is left that stands out of the noise."""

from __future__ import annotations

from diagnosis.discovery.search.iterate import searched, trusting
from diagnosis.discovery.state import State


def stepwise(state: State) -> State:
    """Search for causes in the mean, from those that the joint fit holds already."""
    kept_out = state.touched
    found = None
    if not state.keys:
        state = state.with_(baseline=state.fit)
        found = trusting(state.fit, state.searched, state.step, kept_out)
    found = found or searched(state.fit, state.searched, state.keys, step=state.step, also=kept_out)
    return state.with_(found.fit, keys=found.keys, looked_at=found.looked_at)
