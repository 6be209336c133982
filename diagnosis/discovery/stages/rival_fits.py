"""Rival fits: all that explains the readings as well, so that the factors' intervals hold what that leaves open."""

from __future__ import annotations

from diagnosis.discovery.search.every_start import from_every_start
from diagnosis.discovery.state import State


def rival_fits(state: State) -> State:
    """Fit each rival in its cause's place from wherever the sweep leaves its shape open."""
    found = [
        (name, fit)
        for cause in state.causes
        for name, rival in cause.rivals.items()
        for fit in from_every_start(rival, name)
    ]
    return state.with_(rival_fits=tuple(found)) if found else state
