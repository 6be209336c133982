"""Rounds of the search: until neither the causes, nor the rows left out, nor the blur of the stairs change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.noise_choice import radius_noise
from diagnosis.discovery.marks.row_masks import mask_spikes
from diagnosis.discovery.marks.stairs import reblurred
from diagnosis.discovery.search.likelihood_ratio import settle
from diagnosis.discovery.search.stepwise import search
from twin.effect import BoolArray, Effect

ROUNDS = 3
RADIUS_LEFT = 1.5
"""Variance of the radius against that of its noise above which something in it is unexplained."""


def searched(
    fit: Fit, effects: Sequence[Effect], keys: Sequence[str], step: float, also: BoolArray
) -> tuple[Fit, list[str], int]:
    """Search, look again for spikes and at the blur of the stairs in what is left, and search on until all is still."""
    keys = list(keys)
    looked = 0
    for _ in range(ROUNDS):
        found = search(fit, effects, keys=keys)
        fit, looked = found.fit, found.looked_at
        changed = list(found.keys) != keys
        keys = list(found.keys)
        _, refined = mask_spikes(fit, step, also)
        refined = reblurred(refined, step)
        if not changed and np.array_equal(refined.evidence.usable, fit.evidence.usable):
            break
        fit = solve(refined)
    return fit, keys, looked


def trusting(fit: Fit, effects: Sequence[Effect], step: float, also: BoolArray) -> tuple[Fit, list[str], int] | None:
    """The search that takes all the radius does over the turn for the work of causes; None where they leave some of it.

    A shaft's error shows in the angle alone, and it is the radius that tells it from offset, gain and phase; but a
    field that changes over the turn for reasons of its own would pass for such an error.
    """
    if fit.evidence.observables == 1 or _radius_explained(settle(fit)[0]):
        return None
    trusting = evaluate(fit.chain, fit.free, fit.evidence, replace(fit.setting, radius_trusted=True))
    found = searched(solve(trusting), effects, [], step, also)
    return found if _radius_explained(found[0]) else None


def _radius_explained(fit: Fit) -> bool:
    """Whether what is left of the radius is its noise alone, as it is beside all that the angle could explain."""
    noise = radius_noise(fit)
    if noise is None:
        return True
    left = fit.cosine_residual[1] ** 2 @ fit.setting.family.weights[noise[0]]
    return float(left / fit.rows) < RADIUS_LEFT * noise[1]
