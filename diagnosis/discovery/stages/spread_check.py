"""Spread check: what was said to make some rows louder goes where the causes that are proven do not bear it out.

It was judged on what a search had left, which may have held more causes than the proof has kept.
"""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.marks.row_masks import scaled
from diagnosis.discovery.marks.spread import spread_shapes
from diagnosis.discovery.state import State


def spread_check(state: State) -> State:
    """Judge each shape of the noise's variance once more; what goes leaves the rows as loud as one another."""
    named = {finding.keys[0] for finding in state.findings}
    effects = [effect for effect in state.effects if effect.spread is not None and effect.name in named]
    if not effects:
        return state
    fit = state.fit
    # That it was chosen among several was paid for when it was found.
    improbable = {one.name for one in spread_shapes(fit, effects) if one.log_p < state.settings.footprint_log_p}
    gone = [effect.name for effect in effects if effect.name not in improbable]
    if not gone:
        return state
    plain = evaluate(fit.chain.without(*gone), fit.free, fit.observations, fit.weighting)
    kept = tuple(finding for finding in state.findings if finding.keys[0] not in gone)
    return state.with_(scaled(plain, np.ones(len(fit.observations))), findings=kept)
