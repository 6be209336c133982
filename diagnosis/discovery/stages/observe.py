"""Observe: the sweep as rows that count as independent angles, and the grid on which its readings lie."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.free_parameters import BASELINE
from diagnosis.discovery.fitting.initial_fit import unfitted
from diagnosis.discovery.fitting.observations import collect
from diagnosis.discovery.marks.quantisation import grid_bits
from diagnosis.discovery.marks.row_masks import rows_of
from diagnosis.discovery.settings import CAUSE_PARAMETERS
from diagnosis.discovery.state import State
from twin.errors import SweepError


def observe(state: State) -> State:
    """Prepare the observations: repeats averaged, doubtful rows set aside, the output's word length found.

    Raises SweepError where they are too few to carry a verdict.
    """
    observations = collect(state.sweep)
    _check_enough(state, len(observations))
    observations = observations.masked(observations.usable & ~rows_of(observations, state.suspects))
    bits = grid_bits(np.radians(state.sweep.measured_deg[~state.touched]), state.settings)
    return state.with_(unfitted(observations, state.start, state.settings), bits=bits)


def _check_enough(state: State, rows: int) -> None:
    """Raise SweepError where nothing could be seen in so few rows, so that finding nothing would say nothing."""
    fitted = len(BASELINE)
    fewest = state.settings.fewest_rows(fitted, state.family("mean"))
    if rows < fewest:
        repeated = "" if rows == len(state.sweep) else f" at {rows} angles: what is repeated in place counts once"
        raise SweepError(
            f"{state.sweep.name}: {len(state.sweep)} readings{repeated}; expected at least {fewest} to say whether "
            f"anything is wrong: {fitted} for what is fitted, {CAUSE_PARAMETERS} for a cause, and "
            f"{fewest - fitted - CAUSE_PARAMETERS} to tell it from chance; take more readings, or see what halltwin "
            "diagnose says of these"
        )
