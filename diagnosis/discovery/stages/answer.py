"""Answer: the findings as entries, one a cause, with the held-out RMS before and after each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.finding import Finding, merge
from diagnosis.discovery.fitting.observations import of_readings
from diagnosis.discovery.marks.stairs import without_stairs
from diagnosis.discovery.proof.cross_validation import rms_deg
from diagnosis.discovery.state import State
from twin.catalogue import find


def answer(state: State) -> State:
    """Merge instances of one effect, and give every entry its figures, over single readings."""
    return state.with_(causes=tuple(_with_figures(entry, state) for entry in merge(state.findings)))


def _with_figures(entry: Finding, state: State) -> Finding:
    """The entry with its RMS before and after; of causes that no fit of the mean carries from what they leave."""
    fit, (_, held) = state.fit, state.held_out
    use = fit.observations.usable
    before, after = entry.before_deg, entry.after_deg
    if not np.isfinite(before):
        before = after = rms_deg(held, use)
        if entry.rows:
            before = rms_deg(held, np.ones_like(use))
        elif find(entry.keys[0], fit.chain.effects).footprint == "values":
            before, after = rms_deg(without_stairs(fit, entry.keys[0]), use), rms_deg(fit.residual[0], use)
    return replace(
        entry, before_deg=of_readings(before, fit.observations), after_deg=of_readings(after, fit.observations)
    )
