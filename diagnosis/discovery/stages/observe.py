"""Observe: the sweep as rows that count as independent angles, and the grid on which its readings lie."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.initial_fit import unfitted
from diagnosis.discovery.fitting.observations import collect
from diagnosis.discovery.marks.quantisation import grid_bits
from diagnosis.discovery.marks.row_masks import rows_of
from diagnosis.discovery.state import State


def observe(state: State) -> State:
    """Prepare the observations: repeats averaged, doubtful rows set aside, the output's word length found."""
    observations = collect(state.sweep)
    observations = observations.masked(observations.usable & ~rows_of(observations, state.suspects))
    bits = grid_bits(np.radians(state.sweep.measured_deg), state.settings)
    return state.with_(unfitted(observations, state.start, state.settings), bits=bits)
