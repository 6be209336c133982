"""Columns that count rows: no angle, unless the shaft was turned by the same step from row to row."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.logs.names import SURE, Meaning

_FEWEST = 4


def counts_rows(values: Array, said: Meaning) -> bool:
    """Whether a column (n,) goes on by one and the same whole step in every row, and no word calls it an angle.

    ``tick``, ``line``, ``point`` or ``stamp`` may stand above the numbers of rows, or above a clock's even beats: how
    many of them make a turn would be told by how many rows there are. What is called a reference, a drive or a sensor,
    or has a unit of an angle, may well go on so, as a shaft that is stepped does. A step of one counts rows even where
    the name says a reading.
    """
    if said.reference or said.unit is not None or values.size < _FEWEST:
        return False
    steps = np.unique(np.diff(values))
    if steps.size != 1 or steps[0] == 0.0 or steps[0] % 1.0 != 0.0:
        return False
    return not said.sensor or (said.sensor < SURE and abs(steps[0]) == 1.0)
