"""Rows under the three ways to count them: observations, places in the recording as read, numbers in the file."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.observations import Observations
from twin.angles import IntArray
from twin.sweep import Sweep


def place_in_recording(sweep: Sweep, observations: Observations, row: int, *, last: bool = False) -> int:
    """Place (from 0) among the readable rows of the recording of the first or last reading of an observation.

    By it a chain that simulates the recording counts its rows.
    """
    side = np.searchsorted(observations.group, row, "right" if last else "left") - (1 if last else 0)
    number = int(sweep.numbers[side])
    return number - 1 - sum(1 for rejected in sweep.rejected if rejected < number)


def number_in_file(sweep: Sweep, place: int) -> int:
    """Number (the first reading of the file being 1) of the row at a place among the readable ones."""
    return int(_readable(sweep)[place])


def _readable(sweep: Sweep) -> IntArray:
    """Numbers of the rows that can be read, in use or set aside."""
    numbers = np.arange(1, sweep.rows + 1)
    return numbers[~np.isin(numbers, list(sweep.rejected))]
