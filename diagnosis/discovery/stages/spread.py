"""Spread: causes that show in how much the readings scatter, judged on what the search leaves."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.marks.row_masks import scaled
from diagnosis.discovery.marks.row_numbers import place_in_recording
from diagnosis.discovery.marks.spread import SpreadFinding, bursts, spread_shapes
from diagnosis.discovery.stages.recording_levels import recording_levels
from diagnosis.discovery.state import State
from twin.catalogue import find, unnamed


def spread(state: State) -> State:
    """Name what makes some rows louder than others, and weigh the rows by it: they then tell more than before.

    Judged once: how loud it is does not depend on what the better weights find afterwards.
    """
    if state.found("spread"):
        return state
    if (levelled := recording_levels(state)) is not state:
        # A level told by neighbours far apart held what the search has found since: the next round judges by the new.
        return levelled
    fit = state.fit
    shapes = spread_shapes(fit, [effect for effect in state.effects if effect.footprint == "spread"])
    burst = bursts(fit)
    if burst is not None:
        shapes.append(burst)
    family = state.family("spread")
    odds = state.settings.unnamed_log_odds
    # What a shape without a name leaves lies in some places of the turn: uneven, whatever the colour of the noise.
    limit = state.settings.effect_log_p(family) - (odds if any(map(unnamed, state.keys)) else 0.0)
    judged = [(shape.log_p + (odds if unnamed(shape.name) else 0.0), shape) for shape in shapes]
    score, best = min(judged, key=lambda item: item[0], default=(0.0, None))
    if best is None or score > limit:
        if np.all(fit.observations.scale == fit.observations.level):
            return state
        # What looked like uneven noise before the search was structure: a scale that no cause carries goes.
        return state.with_(scaled(fit, np.ones(len(fit.observations))))
    chain = fit.chain.with_values({best.name: _in_recording(state, best)})
    intervals = {(best.name, name): limits for name, limits in best.intervals.items()}
    named = Finding.among(family, best.name, best.log_p, gain=best.gain, intervals=intervals)
    weighed = scaled(evaluate(chain, fit.free, fit.observations, fit.weighting), best.variance)
    return state.with_(weighed, findings=(*state.findings, named))


def _in_recording(state: State, found: SpreadFinding) -> dict[str, float]:
    """The parameters found, those that count rows as places in the recording, as the chain counts them."""
    params = find(found.name, state.fit.chain.effects).params
    observations = state.fit.observations
    return {
        name: float(place_in_recording(state.sweep, observations, int(value), last=name.startswith("last")))
        if params[name].unit == "row"
        else value
        for name, value in found.values.items()
    }
