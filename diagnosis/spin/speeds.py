"""Whether a log has several speeds."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.pace import LEAST_SPEEDS


def several_speeds(speed: Array) -> bool:
    """Whether speeds (n,) of a motion lie so far apart that what follows them may show."""
    slow, fast = np.quantile(np.abs(speed), [0.1, 0.9])
    return bool(fast - slow > LEAST_SPEEDS * fast)
