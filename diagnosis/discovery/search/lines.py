"""Lines over the turn in a joint fit: which ones causes make, and one cause in the place of several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.search.likelihood_ratio import add, likelihood, settle, take_out
from diagnosis.discovery.search.screening import Base, screen_one
from twin.angles import Array
from twin.catalogue import find
from twin.effect import Effect

_LOW = frozenset(range(1, 9))
"""Orders that a real field, or a saturating concentrator, leaves in the radius."""
_WHOLE = 0.1
"""A fitted order counts as the whole number that it lies so near to, as a share of what the record resolves."""


def resolved(fit: Fit) -> float:
    """By how much two orders of a line may differ that a fit does not tell apart."""
    return _WHOLE / max(fit.observations.motion.turns, 1.0)


def lines_of(fit: Fit, keys: Sequence[str]) -> dict[str, tuple[int, ...]]:
    """The whole orders of the lines that each of these causes makes, of those that make nothing else."""
    near = resolved(fit)
    found = {}
    for key in keys:
        comb = find(key, fit.chain.effects).comb
        orders = () if comb is None else comb.orders(fit.chain.values[key])
        if orders and all(abs(order - round(order)) <= near for order in orders):
            found[key] = tuple(round(order) for order in orders)
    return found


def waves_in_radius(fit: Fit, order: int) -> bool:
    """Whether the channels' radius has a wave of this order over the turn, beyond what the fit has and chance makes.

    Chance is what stands beside it in the radius: another constant and low orders are none of this wave.
    """
    if fit.observations.observables == 1:
        return False
    use, angle = fit.observations.usable, fit.observations.motion.shaft_rad
    others = [np.ones_like(angle), *(turned(k * angle) for k in _LOW - {order} for turned in (np.cos, np.sin))]
    waves = [turned(order * angle) for turned in (np.cos, np.sin)]
    radius = fit.residual[1][use]
    left = [_left(radius, np.stack(columns, axis=1)[use]) for columns in (others, [*others, *waves])]
    gain = radius.size * float(np.log(left[0] / left[1])) if left[1] > 0.0 else 0.0
    return gain > fit.settings.same_fit(coarse=fit.weighting.coarse)


def _left(values: Array, columns: Array) -> float:
    """Squares that least squares by these columns (n, q) leaves of values (n,)."""
    factors, *_ = np.linalg.lstsq(columns, values, rcond=None)
    return float(np.sum((values - columns @ factors) ** 2))


def in_their_place(
    fit: Fit, effect: Effect, keys: Sequence[str], *, shape: Mapping[str, float], orders: Sequence[int]
) -> tuple[Fit, tuple[str, ...]] | None:
    """The fit with these lines as those of one cause, and their keys; None where it fits the readings less well.

    Each line may move by what a fit of it alone is uncertain by: an order that was free is now whole.
    """
    joint = fit
    for key in keys:
        joint = take_out(joint, key)
    added = []
    for order in orders:
        candidate = screen_one(Base.of(joint), effect, shapes=[{**shape, "order": float(order)}])
        if candidate is None:
            return None
        joint, key = add(joint, candidate)
        added.append(key)
    joint, _ = settle(joint)
    lost = 2.0 * (likelihood(fit) - likelihood(joint))
    return (joint, tuple(added)) if lost < len(orders) * fit.settings.same_fit(coarse=fit.weighting.coarse) else None
