"""The times at which readings were taken: as they are stamped, or of an even clock behind coarse stamps."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, IntArray

_COARSE = 0.2
"""Share of the usual step from which on the stamps' grid counts: a fifth of a step is a fifth of the way turned."""


def even_clock(time_s: Array, number: IntArray | None = None) -> Array | None:
    """The even clock (n,) [s] that explains stamps which a coarse grid rounds; None where there is none.

    Readings that a device takes evenly are stamped when they arrive: in frames of a bus, or by a clock of whole
    milliseconds. Then all stamps lie within the grid's step behind one straight line over the readings' number.
    ``number`` (n,) is that of each reading where some are missing; not given: none is.
    """
    grid = _grid(time_s)
    if grid is None:
        return None
    taken = np.arange(time_s.size) if number is None else number
    slope, first = np.polyfit(taken, time_s, 1)
    even = first + slope * taken
    # The line stands in the middle of what rounding does; where that is nothing, the stamps are the clock's own.
    if slope > 0.0 and 1e-3 * grid < float(np.max(np.abs(time_s - even))) < 1.5 * grid:
        return np.asarray(even)
    return None


def _grid(time_s: Array) -> float | None:
    """The step [s] of the stamps' grid where it is coarse against the readings' spacing."""
    steps = np.diff(time_s)
    usual = float(np.mean(steps))
    own = np.unique(np.round(steps / usual, 6))
    if own.size < 2:
        return None
    grid = float(np.min(np.diff(own))) * usual
    whole = np.abs(steps / grid - np.round(steps / grid))
    return grid if grid > _COARSE * usual and float(np.max(whole)) < 1e-2 else None
