"""Global search for the minimum on the quadratic form: the swarm, where descents from several starts disagree.

The swarm's range is widened where its best particle stands at the edge.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import least_squares, model, swarm
from diagnosis.error_model.error_band import outside
from diagnosis.error_model.first_look import Look
from diagnosis.error_model.model import ZERO
from diagnosis.error_model.search_range import Box, at_wall, first_box, widened
from twin.angles import Array


class GlobalSearch:
    """What was found for each sweep of the batch, by descents or, filled in round by round, by the swarm."""

    def __init__(self, box: Box, gram: Array) -> None:
        batch = gram.shape[0]
        self.box = box
        self.gram = gram
        """The quadratic forms (batch, 10, 10), those of widened sweeps with weights 1/r^2."""
        self.best: Array = np.zeros((batch, 6))
        self.cost: Array = np.zeros(batch)
        self.zero_only: Array = np.zeros(batch)
        """Cost (batch,) of an ideal sensor turned by the mean error."""
        self.evaluations: NDArray[np.int64] = np.zeros(batch, dtype=np.int64)
        self.rounds: NDArray[np.int64] = np.zeros(batch, dtype=np.int64)
        """Of the swarm; 0 where descents from all starts have found one minimum."""
        self.discarded: NDArray[np.int64] = np.zeros(batch, dtype=np.int64)
        self.histories: list[tuple[Array, Array]] = [(np.zeros(0), np.zeros(0))] * batch
        """Of the last round: the best of all and the mean of the own bests after each iteration."""


QUICK = swarm.SwarmSettings(particles=32, iterations=64, stop_settled=True)
"""Enough to come near the minimum; least squares does the rest. The paper's own setting is ``SwarmSettings()``."""


def search(
    look: Look, *, settings: swarm.SwarmSettings | None, rng: np.random.Generator, band_rad: float | None = None
) -> GlobalSearch:
    """Find each sweep's minimum.

    With ``settings``, or ``band_rad``, the Delta E of the discard rule (Eq. 11), the swarm is asked for; else it runs
    where the descents of the first look do not end in one minimum: in the range of Table 2, and in a wider one while
    its best particle stands at the edge.
    """
    readings, start = look.readings, look.start
    found = GlobalSearch(first_box(start[:, ZERO]), look.gram.copy())
    ideal_coefs = model.coefficients(start)
    found.zero_only = np.maximum(np.einsum("bi,bij,bj->b", ideal_coefs, found.gram, ideal_coefs), 0.0)
    active = np.arange(start.shape[0])
    if settings is None and band_rad is None:
        _take(found, look)
        active = np.flatnonzero(~look.agreed)
    settings = QUICK if settings is None else settings
    while active.size:
        root = model.factor(found.gram[active])
        lower, upper = found.box.lower[active], found.box.upper[active]
        result = swarm.run(
            partial(_cost, root=root),
            lower,
            upper,
            rng=rng,
            settings=settings,
            outside=None if band_rad is None else outside(readings.sweeps(active), band_rad),
        )
        found.best[active] = result.best
        found.cost[active] = result.best_cost
        found.evaluations[active] += result.evaluations
        found.rounds[active] += 1
        found.discarded[active] += result.discarded
        for k, sweep in enumerate(active):
            found.histories[sweep] = (result.best_history[k], result.own_history[k])
        walls = np.zeros(found.best.shape, dtype=np.bool_)
        walls[active] = at_wall(result.best, lower, upper)
        active = np.flatnonzero(walls.any(axis=1))
        if active.size:
            found.box = widened(found.box, walls)
            # The errors are large: from here on the weights 1/r^2 count.
            found.gram[active] = readings.sweeps(active).gram(found.best[active])
    return found


def _take(found: GlobalSearch, look: Look) -> None:
    """Take the ends of the descents that agree, in ranges that are wide enough for them."""
    settled = look.agreed
    found.best[settled], found.cost[settled] = look.points[settled], look.cost[settled]
    while (walls := at_wall(look.points, found.box.lower, found.box.upper) & settled[:, None]).any():
        found.box = widened(found.box, walls)
    wide = np.flatnonzero(found.box.widened.any(axis=1))
    if wide.size:
        # The errors are large: the weights 1/r^2 count.
        found.gram[wide] = look.readings.sweeps(wide).gram(look.points[wide])
        again = least_squares.descend_on_gram(found.gram[wide], look.points[wide], count=look.readings.count)
        found.best[wide], found.cost[wide] = again.points, again.cost


def _cost(points: Array, *, root: Array) -> Array:
    """Cost (batch, particles) of points (batch, particles, 6) on factors (batch, 10, 10) of the quadratic forms."""
    return model.cost(model.coefficients(points), root)
