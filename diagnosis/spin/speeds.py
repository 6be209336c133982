"""Which speeds a log has: several, or two alone."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.pace import LEAST_SPEEDS

_SELDOM = 0.01
"""Share of the readings at one speed that may be faster, and slower, than that."""


def several_speeds(speed: Array) -> bool:
    """Whether speeds (n,) of a motion lie so far apart that what follows them may show."""
    slow, fast = np.quantile(np.abs(speed), [0.1, 0.9])
    return bool(fast - slow > LEAST_SPEEDS * fast)


def two_speeds_alone(speed: Array) -> bool:
    """Whether speeds (n,), unless all are one, are those of two steady motions, whatever lies between the two."""
    rising = np.sort(np.abs(speed))
    between = 1 + int(np.argmax(rising[1:] / np.maximum(rising[:-1], 1e-300)))
    for group in (rising[:between], rising[between:]):
        slow, fast = np.quantile(group, [_SELDOM, 1.0 - _SELDOM])
        if fast - slow > LEAST_SPEEDS * fast:
            return False
    return True
