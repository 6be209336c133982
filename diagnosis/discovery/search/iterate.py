"""Iterate: the search again, until neither the causes, nor the rows left out, nor the blur of the stairs change."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.noise.plausible import radius_noise
from diagnosis.discovery.marks.row_masks import mask_spikes
from diagnosis.discovery.marks.stairs import reblurred
from diagnosis.discovery.search.likelihood_ratio import settle
from diagnosis.discovery.search.stepwise import Found, Tell, nobody, search
from twin.effect import BoolArray, Effect


def searched(
    fit: Fit,
    effects: Sequence[Effect],
    keys: Sequence[str],
    *,
    step: float,
    also: BoolArray,
    tell: Tell = nobody,
    promising: Callable[[Fit], bool] = lambda fit: True,
) -> Found:
    """Search, look again for single rows and at the blur of the stairs in what is left, until all is still.

    ``step`` [rad] is that of the output's grid; raw rows in ``also`` (n_raw,) stay masked; ``tell`` hears what is held;
    the search is not made again from a fit that is not ``promising``.
    """
    found = Found(fit, tuple(keys), 0)
    for _ in range(fit.settings.most_rounds):
        before = found.keys
        found = search(fit, effects, before, standings=found.standings, tell=tell)
        refined = reblurred(mask_spikes(found.fit, step, also))
        if found.keys == before and np.array_equal(refined.observations.usable, found.fit.observations.usable):
            return found
        fit = solve(refined)
        if not promising(fit):
            break
    return replace(found, fit=settle(fit)[0])


def trusting(fit: Fit, effects: Sequence[Effect], step: float, also: BoolArray, tell: Tell = nobody) -> Found | None:
    """The search in which everything that the radius does over the turn has to be the work of causes.

    A shaft's error shows in the angle alone, and it is the radius that tells it from offset, gain and phase; but a
    field that changes over the turn for reasons of its own would pass for such an error. So the search is given up
    (None) where its causes leave some of the radius unexplained, and not made where there is nothing to explain. Where
    single rows were not it, further rounds would hardly find the cause that the first has not.
    """
    if fit.observations.observables == 1 or _radius_explained(settle(fit)[0]):
        return None
    weighting = replace(fit.weighting, radius_trusted=True)
    start = solve(evaluate(fit.chain, fit.free, fit.observations, weighting))
    found = searched(start, effects, [], step=step, also=also, tell=tell, promising=_radius_explained)
    return found if _radius_explained(found.fit) else None


def _radius_explained(fit: Fit) -> bool:
    """Whether what is left of the radius is its noise alone, as it is beside all that the angle could explain."""
    noise = radius_noise(fit)
    if noise is None:
        return True
    left = fit.cosine_residual[1] ** 2 @ fit.weighting.family.weights[noise[0]]
    return float(left / fit.rows) < fit.settings.radius_left * noise[1]
