"""First look: descents on the quadratic form in both pairs of senses, and the gross errors that they show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import descents, least_squares, model
from diagnosis.error_model.gross_errors import isolated
from diagnosis.error_model.model import ZERO, Readings
from twin.angles import Array

_ROBUST_ROUNDS = 12


@dataclass(frozen=True, eq=False)
class Look:
    """What the descents found of each sweep, in the pair of senses that fits better.

    ``readings`` have these senses, and weight 0 where they are isolated gross errors that were left out; ``start``
    (batch, 6) is the ideal sensor that :func:`ideal` makes of them, ``gram`` their quadratic form (batch, 10, 10).
    ``swap`` (batch,) says where the senses are not those that were tried first. ``points`` (batch, 6) and ``cost``
    (batch,) are the end of the descent from an ideal sensor, ``agreed`` (batch,) whether those from all starts end
    alike, before any gross error is left out; ``other`` are points and costs of the end in the other senses, None where
    none are tried.
    """

    readings: Readings
    start: Array
    gram: Array
    swap: NDArray[np.bool_]
    points: Array
    cost: Array
    agreed: NDArray[np.bool_]
    other: tuple[Array, Array] | None


def first_look(readings: Readings, reference_rad: Array, *, both: bool, robust: bool) -> Look:
    """Least squares on the quadratic form, with the senses as they are and, if ``both``, swapped.

    With ``robust``, gross errors are found in rounds, because each fit shows more clearly which they are; the sine of
    a gross error counts for one reading at most, so even the first fit is not far off.
    """
    batch = reference_rad.shape[0]
    start = ideal(readings)
    begun = descents.starts(start[:, ZERO])
    gram = readings.gram()
    ended = descents.descend(
        _forms(gram, both=both), np.concatenate([begun, model.mirrored(begun)]) if both else begun, count=readings.count
    )
    points, cost, agreed = ended
    swap = _swapped(cost, batch)
    used, mask = readings, np.zeros(reference_rad.shape, dtype=np.bool_)
    order = np.argsort(np.remainder(reference_rad, 2.0 * np.pi), axis=-1, kind="stable") if robust else None
    base = 1.0 if readings.weights is None else readings.weights
    for _ in range(_ROBUST_ROUNDS):
        if order is None:
            break
        best = np.where(swap[:, None], points[-batch:], points[:batch])
        found = isolated(readings.oriented(swap).residual(best), order, mask, readings.weights)
        if np.array_equal(found, mask):
            break
        mask = found
        used = readings.weighted(np.where(mask, 0.0, base))
        gram = used.gram(np.where(swap[:, None], model.mirrored(best), best))
        coarse = least_squares.descend_on_gram(_forms(gram, both=both), points, count=readings.count)
        points, cost = coarse.points, coarse.cost
        swap = _swapped(cost, batch)
    here, there = (np.where(one, batch, 0) + np.arange(batch) for one in (swap, ~swap))
    kept = used.oriented(swap)
    return Look(
        readings=kept,
        start=start if kept is readings else ideal(kept),
        gram=np.where(swap[:, None, None], model.swapped_gram(gram), gram),
        swap=swap,
        points=points[here],
        cost=cost[here],
        agreed=agreed[here] & agreed[there] if both else agreed,
        other=(points[there], cost[there]) if both else None,
    )


def _forms(gram: Array, *, both: bool) -> Array:
    return np.concatenate([gram, model.swapped_gram(gram)]) if both else gram


def _swapped(cost: Array, batch: int) -> NDArray[np.bool_]:
    """Where (batch,) the swapped senses fit better, of costs (batch,) or both (2 batch,)."""
    return cost[batch:] < cost[:batch] if cost.size > batch else np.zeros(batch, dtype=np.bool_)


def ideal(readings: Readings) -> Array:
    """An ideal sensor turned by the mean of h m - s theta on the circle, for each sweep (batch, 6)."""
    cosine, sine = readings.resultant()
    start = np.tile(model.NOMINAL, (cosine.size, 1))
    start[:, ZERO] = np.arctan2(sine, cosine)
    return start
