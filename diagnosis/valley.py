"""Where the minimum lies: the swarm on the quadratic form, in a range that widens by itself.

Lanes: one a sweep, or two where the senses are free (the swapped pair behind all first ones).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from diagnosis import error_model, polish, swarm
from diagnosis.band import outside
from diagnosis.error_model import ZERO, Readings
from diagnosis.glitches import isolated
from diagnosis.search_range import Box, at_wall, first_box, widened
from twin.angles import Array

_ROBUST_ROUNDS = 12


class Valley:
    """The swarm's outcome for each lane, filled in round by round."""

    def __init__(self, box: Box, gram: Array) -> None:
        lanes = gram.shape[0]
        self.box = box
        self.gram = gram
        self.best: Array = np.zeros((lanes, 6))
        self.cost: Array = np.zeros(lanes)
        self.zero_only: Array = np.zeros(lanes)
        """Cost (lanes,) of an ideal sensor turned by the mean error."""
        self.evaluations: NDArray[np.int64] = np.zeros(lanes, dtype=np.int64)
        self.rounds: NDArray[np.int64] = np.zeros(lanes, dtype=np.int64)
        self.discarded: NDArray[np.int64] = np.zeros(lanes, dtype=np.int64)
        self.histories: list[tuple[Array, Array]] = [(np.zeros(0), np.zeros(0))] * lanes
        """Of the last round: the best of all and the mean of the own bests after each iteration."""


def search(
    readings: Readings,
    *,
    both: bool,
    settings: swarm.SwarmSettings,
    rng: np.random.Generator,
    band_rad: float | None = None,
) -> Valley:
    """Swarm each lane in Table 2's range, and again in a wider one as long as the best stands at a wall.

    ``band_rad`` is the Delta E of the discard rule (Eq. 11); None leaves the rule out.
    """
    start = _ideal(readings, both=both)
    batch = start.shape[0] // 2 if both else start.shape[0]
    valley = Valley(first_box(start[:, ZERO]), _grams(readings, None, both=both))
    valley.zero_only = _costs(start[:, None, :], valley.gram)[:, 0]
    active = np.arange(start.shape[0])
    while active.size:
        root = error_model.factor(valley.gram[active])
        lower, upper = valley.box.lower[active], valley.box.upper[active]
        result = swarm.run(
            lambda points, root=root: error_model.cost(error_model.coefficients(points), root),  # type: ignore[misc]
            lower,
            upper,
            rng=rng,
            settings=settings,
            outside=None if band_rad is None else outside(_lanes(readings, active, both=both), band_rad),
        )
        valley.discarded[active] += result.discarded
        valley.best[active] = result.best
        valley.cost[active] = result.best_cost
        valley.evaluations[active] += result.evaluations
        valley.rounds[active] += 1
        for k, lane in enumerate(active):
            valley.histories[lane] = (result.best_history[k], result.own_history[k])
        walls = np.zeros(valley.best.shape, dtype=np.bool_)
        walls[active] = at_wall(result.best, lower, upper)
        # Both pairs of senses of a sweep go on together, on weights 1/r^2 that now follow the better of them.
        again = np.unique(np.flatnonzero(walls.any(axis=1)) % batch)
        if again.size:
            valley.box = widened(valley.box, walls)
            around, _ = _better(valley.best, valley.cost, both=both)
            active = np.concatenate([again, again + batch]) if both else again
            valley.gram[active] = _grams(readings.sweeps(again), around[again], both=both)
        else:
            active = again
    return valley


def without_glitches(readings: Readings, reference_rad: Array, *, both: bool) -> Readings:
    """The readings with weight 0 where they are isolated gross errors.

    In rounds, because each fit shows more clearly which they are. The sine of a gross error counts for one reading
    at most, so even the first fit is not far off.
    """
    order = np.argsort(np.remainder(reference_rad, 2.0 * np.pi), axis=-1, kind="stable")
    base = np.ones(reference_rad.shape) if readings.weights is None else readings.weights
    used, mask = readings, np.zeros(reference_rad.shape, dtype=np.bool_)
    points = _ideal(readings, both=both)
    gram = _grams(readings, None, both=both)
    for _ in range(_ROBUST_ROUNDS):
        coarse = polish.descend(polish.on_gram(gram), points, count=readings.count)
        points = coarse.points
        around, swap = _better(points, coarse.cost, both=both)
        exact = np.where(swap[:, None], points[-swap.size :], points[: swap.size])
        found = isolated(readings.oriented(swap).residual(exact), order, mask, readings.weights)
        if np.array_equal(found, mask):
            break
        mask = found
        used = readings.weighted(np.where(mask, 0.0, base))
        gram = _grams(used, around, both=both)
    return used


def _better(points: Array, cost: Array, *, both: bool) -> tuple[Array, NDArray[np.bool_]]:
    """The better lane of each sweep, as a point (batch, 6) of the first pair of senses, and where it was swapped."""
    if not both:
        return points, np.zeros(cost.size, dtype=np.bool_)
    first, second = np.split(points, 2)
    swap = cost[first.shape[0] :] < cost[: first.shape[0]]
    return np.where(swap[:, None], error_model.mirrored(second), first), swap


def _lanes(readings: Readings, active: NDArray[np.intp], *, both: bool) -> Readings:
    batch = readings.cos_shaft.shape[0]
    return readings.sweeps(active % batch).oriented(active >= batch) if both else readings.sweeps(active)


def _grams(readings: Readings, around: Array | None, *, both: bool) -> Array:
    gram = readings.gram(around)
    return np.concatenate([gram, error_model.swapped_gram(gram)]) if both else gram


def _costs(points: Array, gram: Array) -> Array:
    return error_model.cost(error_model.coefficients(points), error_model.factor(gram))


def _ideal(readings: Readings, *, both: bool) -> Array:
    """For each lane an ideal sensor turned by the mean of h m - s theta on the circle (lanes, 6)."""
    c = readings.cos_read * readings.cos_shaft + readings.sin_read * readings.sin_shaft
    s = readings.sin_read * readings.cos_shaft - readings.cos_read * readings.sin_shaft
    if readings.weights is not None:
        c, s = c * readings.weights, s * readings.weights
    zero = np.arctan2(s.sum(axis=-1), c.sum(axis=-1))
    start = np.tile(error_model.NOMINAL, (2 * zero.size if both else zero.size, 1))
    start[:, ZERO] = np.concatenate([zero, -zero]) if both else zero
    return start
