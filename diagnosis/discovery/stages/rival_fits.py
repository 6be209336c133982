"""Rival fits: all that explains the readings as well, so that the factors' intervals hold what that leaves open."""

from __future__ import annotations

from diagnosis.discovery.fitting.open_effects import odds_of, open_beside
from diagnosis.discovery.search.every_start import from_every_start
from diagnosis.discovery.search.likelihood_ratio import TO_THE_END, solve_tidy
from diagnosis.discovery.state import State


def rival_fits(state: State) -> State:
    """Fit each rival in its cause's place from wherever the sweep leaves its shape open, and what a cause hides."""
    found = [
        (name, fit)
        for cause in state.causes
        for name, rival in cause.rivals.items()
        for fit in from_every_start(rival, name)
    ]
    solved = {name: solve_tidy(fit, iterations=TO_THE_END) for name, fit in open_beside(state.fit).items()}
    beside = [(name, fit, odds) for name, fit in solved.items() if (odds := odds_of(fit, state.fit, name)) > 0.0]
    return state.with_(rival_fits=tuple(found), fits_beside=tuple(beside)) if found or beside else state
