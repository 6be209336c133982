"""Quantisation: the stairs that the set of values shows become part of the model before anything else is searched."""

from __future__ import annotations

from diagnosis.discovery.marks.quantisation import with_stairs
from diagnosis.discovery.state import State


def quantisation(state: State) -> State:
    """Add the output's grid where it is not small against the noise, and the finite set of a truncated CORDIC."""
    fit, found = with_stairs(state.fit, state.sweep, state.effects, bits=state.bits, family=state.family("values"))
    return state.with_(fit, findings=(*state.findings, *found))
