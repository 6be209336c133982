"""Held-out selection: what gains nothing on readings that no fit has seen, or might be chance, is no cause."""

from __future__ import annotations

from copy import deepcopy

from diagnosis.discovery.proof.selection import select
from diagnosis.discovery.state import State


def held_out_selection(state: State) -> State:
    """Keep the causes of the joint fit that are proven, each with its probability, rivals and held-out figures.

    Of a search that was stopped no rivals: whoever has stopped it waits for the answer, and of a budget that is spent
    nothing is left for them.
    """
    rng = deepcopy(state.rng)
    stopped = state.watch.stopped_in is not None
    proof = select(state.fit, state.searched, state.keys, rng=rng, at_once=stopped)
    findings = (*proof.entries(), *state.findings)
    return state.with_(proof.fit, keys=proof.ordered, held=proof.held, fold=proof.fold, findings=findings, rng=rng)
