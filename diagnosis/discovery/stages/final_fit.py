"""Final fit: the optimum itself, where edges of stairs have slopes; and the baseline on the same observations."""

from __future__ import annotations

from diagnosis.discovery.fitting.joint_fit import evaluate, solve
from diagnosis.discovery.marks.stairs import on_average, with_slopes
from diagnosis.discovery.state import State


def final_fit(state: State) -> State:
    """Solve the extended fit to its optimum, and the baseline without any cause by the same rows and weights."""
    fit, baseline = state.fit, state.baseline or state.fit
    by_values = {effect.name for effect in state.effects if effect.footprint == "values"}
    stairs = [finding.keys[0] for finding in state.findings if finding.keys[0] in by_values]
    plain = solve(evaluate(baseline.chain.without(*stairs), baseline.free, fit.observations, fit.weighting))
    return state.with_(on_average(with_slopes(fit)), baseline=on_average(plain))
