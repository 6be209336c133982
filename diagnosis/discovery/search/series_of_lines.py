"""Series of lines: whether a line at a whole order is the next multiple of a series without a name.

A belt, a gear or a bearing that meets the shaft at a fraction of its speed makes a line at that order and at its
multiples, which fall off. A multiple that comes to lie on a whole order looks like a line of what turns with the shaft.
"""

from __future__ import annotations

from collections.abc import Sequence

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.search.lines import in_their_place, lines_of, resolved
from twin.catalogue import base_name, find
from twin.empirical.orders import UNNAMED_ORDER

_LEAST = 3
"""Lines at the first, second and third multiple of one order are a series: two may stand so by chance."""


def as_next_of_a_series(fit: Fit, keys: Sequence[str]) -> tuple[Fit, tuple[str, ...]] | None:
    """The fit with a cause's single line as the next of a series of lines without a name; None where there is none.

    It must be smaller than the last of the series, and the readings must be explained as well.
    """
    series = _series(fit, keys)
    if series is None:
        return None
    first, last = series
    following = round(_of(fit, last, "order") / first) + 1
    for key, orders in lines_of(fit, keys).items():
        if base_name(key) == UNNAMED_ORDER.name or len(orders) > 1:
            continue
        near = abs(orders[0] - following * first) <= following * resolved(fit)
        if near and _of(fit, key, "amplitude_deg") < _of(fit, last, "amplitude_deg"):
            trial = in_their_place(fit, find(UNNAMED_ORDER.name, fit.chain.effects), [key], shape={}, orders=orders)
            if trial is not None:
                joint, added = trial
                return joint, (*(one for one in keys if one != key), *added)
    return None


def _series(fit: Fit, keys: Sequence[str]) -> tuple[float, str] | None:
    """The order that the lines without a name are multiples of, one after the other, and the key of the last line."""
    lines = sorted(
        (key for key in keys if base_name(key) == UNNAMED_ORDER.name), key=lambda key: _of(fit, key, "order")
    )
    if len(lines) < _LEAST:
        return None
    first = _of(fit, lines[0], "order")
    at_multiples = (
        abs(_of(fit, key, "order") - place * first) <= place * resolved(fit) for place, key in enumerate(lines, start=1)
    )
    return (first, lines[-1]) if all(at_multiples) else None


def _of(fit: Fit, key: str, name: str) -> float:
    return float(fit.chain.values[key][name])
