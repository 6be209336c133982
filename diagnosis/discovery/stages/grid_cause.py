"""Grid as a cause: whether the output's rounding is among what limits the readings."""

from __future__ import annotations

from diagnosis.discovery.marks.quantisation import grid_as_cause
from diagnosis.discovery.state import State
from twin.catalogue import output_grid


def grid_cause(state: State) -> State:
    """Name the output's grid where its stairs are seen and make much of what is left; beside no other finite set."""
    grid = output_grid(state.effects)
    if grid is None or state.found("values"):
        return state
    cause = grid_as_cause(state.fit, grid, step=state.step, family=state.family("values"))
    return state if cause is None else state.with_(findings=(*state.findings, cause))
