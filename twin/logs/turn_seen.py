"""The turn of an angle that begins anew with it, in the unit of its numbers: told by the numbers alone."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.logs.restarts import restarts

_FEWEST = 32
_GAPS = 2.0
"""The gap over which an angle begins anew is one of those between its numbers, put in order; the widest of them is that
one or a few per cent of it wider. Twice the widest of the others is far beyond what any even turning leaves there."""
_OF_WORDS = 0.05
"""Share of readings that a fixed word may stand in for, such as -1 or 65535 where a transfer failed."""


Turn = tuple[float, float]
"""Two numbers between which a turn lies."""


_ROUNDED = 1e-3
"""Share of a turn by which its unit may fall short of the span of the values, which are printed with few digits."""


def is_turn(turn: float, seen: Turn) -> bool:
    """Whether a turn is this long in a unit that has a name, for what was seen of it."""
    low, high = seen
    return low * (1.0 - _ROUNDED) <= turn <= high


def turns_seen(values: Array) -> list[Turn]:
    """Between which two numbers the turn lies of an angle that begins anew, the likeliest first.

    Parameters
    ----------
    values : ndarray
        The angle (n,) in the order of the readings, in any unit; what is not finite is left out.

    Returns
    -------
    list of tuple
        The span of the values, and the span with the widest gap that their order allows for; also without their
        smallest or largest where that may be a fixed word. Empty where they never begin anew, or where the gap over
        which they do is none of a turn that is filled.
    """
    known = values[np.isfinite(values)]
    kept = [one for one in (known, *_without_a_word(known)) if one.size >= _FEWEST and np.any(restarts(one))]
    return [seen for one in kept if (seen := _seen(one)) is not None]


def _without_a_word(values: Array) -> list[Array]:
    """The values without their smallest, and without their largest, where it may be a fixed word."""
    ends = [np.min(values), np.max(values)] if values.size else []
    rest = [values[values != end] for end in ends]
    return [one for one in rest if one.size >= (1.0 - _OF_WORDS) * values.size]


def _seen(values: Array) -> Turn | None:
    different = np.unique(values)
    span = float(different[-1] - different[0])
    gaps = np.diff(different)
    if gaps.size < _FEWEST // 2:
        return None
    widest = float(np.max(gaps))
    # What fills a turn leaves no gap of a tenth of it, nor does it come back from the middle.
    if widest > 0.1 * span:
        return None
    before = np.flatnonzero(restarts(values))
    near = 0.25 * span
    at_ends = np.minimum(values[before], values[before + 1]) - different[0] < near
    at_ends &= different[-1] - np.maximum(values[before], values[before + 1]) < near
    return (span, span + _GAPS * widest) if np.mean(at_ends) > 0.5 else None
