"""Which sets of causes several air gaps are held against: those of order 1, and those of order 2."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations

from diagnosis.factors.gap_model import CAUSES

CauseSet = tuple[str, ...]
BOTH: CauseSet = ("electronics", "sensor")
TILTED: CauseSet = ("electronics", "sensor", "tilt")
ORDER_2: tuple[CauseSet, ...] = ((), ("electronics",), ("sensor",), BOTH, ("sensor", "tilt"), TILTED)
OF_ORDER_2 = frozenset(TILTED)
BESIDE_SENSOR = frozenset({"magnet", "tilt", "magnet_tilt"})
"""What shows in a product with the sensor's displacement alone."""
_ALWAYS: CauseSet = ("voltage", "reference")
_OFF_AXIS: CauseSet = ("magnet", "magnet_tilt")
ON_AXIS: CauseSet = ("tilt_and_magnet", "both_tilts")
"""What a tilted sensor on the axis senses of the upright field."""
_FEWEST_GAPS = 3
"""From which more is told of the offsets than two of their laws."""


def order_1_sets(gaps: int, *, off_axis: bool, tilted: bool) -> tuple[CauseSet, ...]:
    """Sets of causes of the offsets, the smallest first; each cause takes a gap, so that none has more than there are.

    ``off_axis``: the sensor may be off the axis, and what shows beside it is asked about. ``tilted``: it may be tilted
    on the axis.
    """
    pools = [_ALWAYS]
    if off_axis:
        pools.append(_ALWAYS + _OFF_AXIS)
    if tilted and gaps >= _FEWEST_GAPS:
        pools.append(_ALWAYS + ON_AXIS)
    sets = {one for pool in pools for size in range(min(len(pool), gaps) + 1) for one in combinations(pool, size)}
    return tuple(sorted(sets, key=lambda one: (len(one), [CAUSES.index(name) for name in one])))


def go_together(one: Iterable[str], two: Iterable[str]) -> bool:
    """Whether a set of order 2 holds what a set of order 1 needs: the sensor's displacement, or a tilt on the axis."""
    if "sensor" in two:
        return not set(ON_AXIS) & set(one)
    return not set(_OFF_AXIS) & set(one) and ("electronics" in two or not set(ON_AXIS) & set(one))


def joined(one: Iterable[str], two: Iterable[str]) -> CauseSet:
    """The causes of both sets, in the order of CAUSES."""
    held = {*one, *two}
    return tuple(name for name in CAUSES if name in held)


def most_of_an_order(causes: Sequence[str]) -> int:
    """How many causes of one order there are: each takes two numbers of every gap's four."""
    second = sum(name in OF_ORDER_2 for name in causes)
    return max(second, len(causes) - second)
