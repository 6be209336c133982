"""One source: lines that were found one by one, and that one cause makes together, are put under its name.

And lines that one cause would make, but that belong to a body which makes others beside them, are put under that; as
is one at a whole order that is the next of a series without a name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.search.falling_lines import as_lines_of_a_body, of_a_body
from diagnosis.discovery.search.lines import in_their_place, lines_of
from diagnosis.discovery.search.series_of_lines import as_next_of_a_series
from diagnosis.discovery.state import State
from twin.catalogue import base_name
from twin.effect import Effect


def one_source(state: State) -> State:
    """Take several lines of the joint fit for one cause, where it explains them as well as they do by themselves."""
    for effect in state.searched:
        if effect.comb is not None and effect.comb.unite is not None:
            state = _united(state, effect)
        if effect.comb is not None and effect.comb.falling:
            found = as_lines_of_a_body(state.fit, state.keys, effect)
            state = state if found is None else state.with_(found[0], keys=found[1])
    following = as_next_of_a_series(state.fit, state.keys)
    return state if following is None else state.with_(following[0], keys=following[1])


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
        if _of_a_body(state, covered):
            continue
        if len(effect.comb.unite(covered)) and not _there(fit, effect, replaced, shape):
            trial = in_their_place(fit, effect, replaced, shape=shape, orders=covered)
            if trial is not None:
                joint, added = trial
                return state.with_(joint, keys=(*(key for key in state.keys if key not in replaced), *added))
        break
    return state


def _of_a_body(state: State, orders: Sequence[int]) -> bool:
    """Whether lines of these orders belong to a body that has lines at the orders between them as well."""
    bodies = (one for one in state.searched if one.comb is not None and one.comb.falling)
    return any(of_a_body(state.fit, state.keys, orders, body) for body in bodies)


def _there(fit: Fit, effect: Effect, keys: Sequence[str], shape: Mapping[str, float]) -> bool:
    """Whether all of these are lines of this very cause already."""
    own = (base_name(key) == effect.name and shape.items() <= fit.chain.values[key].items() for key in keys)
    return all(own)
