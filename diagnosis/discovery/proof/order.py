"""Order: which cause stands first, so that each shows what it brings beside those before it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate
from diagnosis.discovery.fitting.projection import projected
from twin.angles import Array, wrap
from twin.catalogue import base_name, find, unnamed


def by_turn(fit: Fit, blocks: Sequence[Sequence[str]]) -> list[int]:
    """Places of the blocks of causes in the order in which they explain the angles of the fit, the most telling first.

    Of those that are left, the next is the one with which the parameters of all so far are expected to come nearest to
    readings that they have not seen: the one of least generalised cross-validation, squares / (rows - parameters)^2
    (Craven and Wahba, Numerische Mathematik 31, 377, 1979), in the fit made linear about its strengths. What a strong
    cause drowns comes after that one, however much it gains in the end. What has no name comes last: it is what no
    cause has explained. A block without strengths keeps its place.
    """
    order = list(range(len(blocks)))
    strengths = [[free.key in block and _is_linear(fit, free) for free in fit.free] for block in blocks]
    left = [place for place in order if any(strengths[place])]
    if len(left) < 2:
        return order
    use = fit.observations.usable
    columns = {place: fit.jacobian[strengths[place], 0][:, use] for place in left}
    explained = fit.residual[0][use] + sum(_does(fit, blocks[place])[use] for place in left)
    keys = {key for place in left for key in blocks[place]}
    next_in = fit.jacobian[[free.key not in keys for free in fit.free], 0][:, use]
    freedom = int(np.count_nonzero(use)) - len(next_in)
    for slot in tuple(left):
        explained = projected(explained, next_in)
        columns = {place: projected(columns[place], next_in) for place in left}
        expected = {
            place: np.sum(projected(explained, columns[place]) ** 2) / max(freedom - sum(strengths[place]), 1) ** 2
            for place in left
        }
        order[slot] = min(left, key=lambda place: (unnamed(base_name(blocks[place][0])), expected[place]))
        left.remove(order[slot])
        next_in = columns[order[slot]]
        freedom -= sum(strengths[order[slot]])
    return order


def is_strength(fit: Fit, free: Free) -> bool:
    """Whether a free parameter is a strength of its effect, or one of several."""
    return find(free.key, fit.chain.effects).params[free.name].role in ("strength", "level", "per turn")


def _is_linear(fit: Fit, free: Free) -> bool:
    """Whether it is a strength, or the phase of one."""
    return is_strength(fit, free) or find(free.key, fit.chain.effects).params[free.name].role == "phase"


def _does(fit: Fit, keys: Sequence[str]) -> Array:
    """By how much these causes turn the angle (n,) [rad]."""
    without = evaluate(fit.chain.without(*keys), (), fit.observations, fit.weighting)
    return np.asarray(wrap(fit.linear.angle - without.linear.angle))
