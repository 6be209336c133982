"""Own shapes: orders, memories and frequencies of a given twin's effects are set free once its causes are known."""

from __future__ import annotations

from diagnosis.discovery.fitting.own_parameters import own_free, tested
from diagnosis.discovery.state import State


def own_shapes(state: State) -> State:
    """Free the shapes of the effects that a given twin has, once it has been searched for causes that it lacks.

    Before, a shape would go anywhere to describe what only a cause explains.
    """
    if state.given is None or not state.looked_at:
        return state
    own = [key for key in state.given.values if key in state.fit.chain.values and key not in state.keys]
    fit = own_free(state.fit, own, shapes=True)
    if len(fit.free) == len(state.fit.free):
        return state
    return state.with_(fit, own=(*state.own, *tested(fit, state.fit)))
