"""Quantisation: the stairs that the set of values shows become part of the model before anything else is searched."""

from __future__ import annotations

from diagnosis.discovery.marks.quantisation import rounded, with_stairs
from diagnosis.discovery.state import State


def quantisation(state: State) -> State:
    """Add the output's grid where it is not small against the noise, and the finite set of a truncated CORDIC.

    A grid on which readings were chosen, such as a table's index, is none of the output.
    """
    if state.bits is not None and not rounded(state.fit, state.sweep, state.step):
        state = state.with_(bits=None)
    fit, found = with_stairs(state.fit, state.sweep, state.effects, bits=state.bits, family=state.family("values"))
    return state.with_(fit, findings=(*state.findings, *found))
