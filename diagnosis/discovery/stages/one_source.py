"""One source: lines that were found one by one, and that one cause makes together, are put under its name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.search.likelihood_ratio import add, likelihood, settle, take_out
from diagnosis.discovery.search.screening import Base, screen_one
from diagnosis.discovery.state import State
from twin.catalogue import base_name, find
from twin.effect import Effect

_WHOLE = 0.1
"""A fitted order counts as the whole number that it lies so near to, as a share of what the record resolves."""


def one_source(state: State) -> State:
    """Take several lines of the joint fit for one cause, where it explains them as well as they do by themselves."""
    for effect in state.searched:
        if effect.comb is not None and effect.comb.unite is not None:
            state = _united(state, effect)
    return state


def _united(state: State, effect: Effect) -> State:
    assert effect.comb is not None
    assert effect.comb.unite is not None
    assert effect.comb.united is not None
    fit = state.fit
    lines = lines_of(fit, state.keys)
    orders = sorted({order for own in lines.values() for order in own})
    for shape in effect.comb.unite(orders) if len(orders) > 1 else ():
        made = set(effect.comb.united(shape))
        replaced = [key for key, own in lines.items() if set(own) <= made]
        covered = sorted({order for key in replaced for order in lines[key]})
        if len(effect.comb.unite(covered)) and not _there(fit, effect, replaced, shape):
            trial = _in_their_place(fit, effect, replaced, shape=shape, orders=covered)
            if trial is not None:
                joint, added = trial
                return state.with_(joint, keys=(*(key for key in state.keys if key not in replaced), *added))
        break
    return state


def lines_of(fit: Fit, keys: Sequence[str]) -> dict[str, tuple[int, ...]]:
    """The whole orders of the lines that each of these causes makes, of those that make nothing else."""
    near = _WHOLE / max(fit.observations.motion.turns, 1.0)
    found = {}
    for key in keys:
        comb = find(key, fit.chain.effects).comb
        orders = () if comb is None else comb.orders(fit.chain.values[key])
        if orders and all(abs(order - round(order)) <= near for order in orders):
            found[key] = tuple(round(order) for order in orders)
    return found


def _there(fit: Fit, effect: Effect, keys: Sequence[str], shape: Mapping[str, float]) -> bool:
    """Whether all of these are lines of this very cause already."""
    own = (base_name(key) == effect.name and shape.items() <= fit.chain.values[key].items() for key in keys)
    return all(own)


def _in_their_place(
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
