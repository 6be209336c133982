"""Stepwise: causes are added, exchanged and removed until nothing is left that stands out of the noise."""

from __future__ import annotations

from dataclasses import replace

from diagnosis.discovery.fitting.joint_fit import evaluate, solve
from diagnosis.discovery.marks.stairs import reblurred
from diagnosis.discovery.search.iterate import searched, trusting
from diagnosis.discovery.search.likelihood_ratio import settle
from diagnosis.discovery.search.stepwise import Found
from diagnosis.discovery.state import State


def stepwise(state: State) -> State:
    """Search for causes in the mean, from those that the joint fit holds already."""
    kept_out = state.touched
    found = None
    if not state.keys and state.given is None:
        state = state.with_(baseline=state.fit)

    def tell(so_far: Found) -> None:
        others = (finding.keys[0] for finding in state.findings)
        state.watch.told("stepwise", (*so_far.keys, *others), lambda: _as_it_stands(state, so_far))

    if not state.keys:
        found = trusting(state.fit, state.searched, state.step, kept_out, tell)
    found = found or searched(state.fit, state.searched, state.keys, step=state.step, also=kept_out, tell=tell)
    return state.with_(found.fit, keys=found.keys, looked_at=found.looked_at)


def _as_it_stands(state: State, found: Found) -> State:
    """The state with what an unfinished search holds.

    Of the radius nothing is taken on trust, and stairs are blurred by the noise that is left now.
    """
    weighting = replace(found.fit.weighting, radius_trusted=False)
    fit = reblurred(evaluate(found.fit.chain, found.fit.free, found.fit.observations, weighting))
    fit, _ = settle(solve(fit))
    return state.with_(fit, keys=found.keys, looked_at=found.looked_at)
