"""Global search for the minimum: a first look by least squares, then the swarm, both on the quadratic form.

The swarm's range is widened where its best particle stands at the edge.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import least_squares, model, swarm
from diagnosis.error_model.error_band import outside
from diagnosis.error_model.gross_errors import isolated
from diagnosis.error_model.model import ZERO, Readings
from diagnosis.error_model.search_range import Box, at_wall, first_box, widened
from twin.angles import Array

_ROBUST_ROUNDS = 12


class GlobalSearch:
    """The swarm's outcome for each sweep of the batch, filled in round by round."""

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
        self.discarded: NDArray[np.int64] = np.zeros(batch, dtype=np.int64)
        self.histories: list[tuple[Array, Array]] = [(np.zeros(0), np.zeros(0))] * batch
        """Of the last round: the best of all and the mean of the own bests after each iteration."""


def search(
    readings: Readings, *, settings: swarm.SwarmSettings, rng: np.random.Generator, band_rad: float | None = None
) -> GlobalSearch:
    """Run each sweep's swarm in the range of Table 2, and in a wider one while its best particle stands at the edge.

    ``band_rad`` is the Delta E of the discard rule (Eq. 11); None leaves the rule out.
    """
    start = _ideal(readings)
    found = GlobalSearch(first_box(start[:, ZERO]), readings.gram())
    found.zero_only = model.cost(model.coefficients(start[:, None, :]), model.factor(found.gram))[:, 0]
    active = np.arange(start.shape[0])
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


def _cost(points: Array, *, root: Array) -> Array:
    """Cost (batch, particles) of points (batch, particles, 6) on factors (batch, 10, 10) of the quadratic forms."""
    return model.cost(model.coefficients(points), root)


def first_look(
    readings: Readings, reference_rad: Array, *, both: bool, robust: bool
) -> tuple[Readings, NDArray[np.bool_]]:
    """Least squares on the quadratic form from an ideal sensor, with the senses as they are and, if ``both``, swapped.

    Returns the readings, with weight 0 where they are isolated gross errors if ``robust``, and where the swapped
    senses (batch,) fit better. Gross errors are found in rounds, because each fit shows more clearly which they are;
    the sine of a gross error counts for one reading at most, so even the first fit is not far off.
    """
    batch = reference_rad.shape[0]
    points = _ideal(readings)
    if both:
        points = np.concatenate([points, model.mirrored(points)])
    elif not robust:
        return readings, np.zeros(batch, dtype=np.bool_)
    order = np.argsort(np.remainder(reference_rad, 2.0 * np.pi), axis=-1, kind="stable") if robust else None
    base = np.ones(reference_rad.shape) if readings.weights is None else readings.weights
    used, mask = readings, np.zeros(reference_rad.shape, dtype=np.bool_)
    gram = readings.gram()
    for _ in range(_ROBUST_ROUNDS):
        forms = np.concatenate([gram, model.swapped_gram(gram)]) if both else gram
        coarse = least_squares.descend(least_squares.on_gram(forms), points, count=readings.count)
        points = coarse.points
        swap = coarse.cost[batch:] < coarse.cost[:batch] if both else np.zeros(batch, dtype=np.bool_)
        if order is None:
            break
        best = np.where(swap[:, None], points[-batch:], points[:batch])
        found = isolated(readings.oriented(swap).residual(best), order, mask, readings.weights)
        if np.array_equal(found, mask):
            break
        mask = found
        used = readings.weighted(np.where(mask, 0.0, base))
        gram = used.gram(np.where(swap[:, None], model.mirrored(best), best))
    return used, swap


def _ideal(readings: Readings) -> Array:
    """An ideal sensor turned by the mean of h m - s theta on the circle, for each sweep (batch, 6)."""
    c = readings.cos_read * readings.cos_shaft + readings.sin_read * readings.sin_shaft
    s = readings.sin_read * readings.cos_shaft - readings.cos_read * readings.sin_shaft
    if readings.weights is not None:
        c, s = c * readings.weights, s * readings.weights
    start = np.tile(model.NOMINAL, (c.shape[0], 1))
    start[:, ZERO] = np.arctan2(s.sum(axis=-1), c.sum(axis=-1))
    return start
