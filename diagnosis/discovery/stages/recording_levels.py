"""Recording levels: each recording of a device is weighed by the noise of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import evaluate, solve
from diagnosis.discovery.fitting.observations import Observations
from diagnosis.discovery.marks.outliers import bounded_rms
from diagnosis.discovery.state import State
from twin.angles import Array

_CHANGED = 0.05
"""Change of a level that is worth another fit: the weights of two recordings then differ by a tenth."""
_SMALLEST = 0.02
"""Level of a recording against the others at which it stops: digits alone are no noise to weigh by."""


def recording_levels(state: State) -> State:
    """Give the rows of each recording the scale that its readings have against their neighbours."""
    fit = state.fit
    if fit.observations.motion.recordings is None:
        return state
    level = _levels(fit.observations, fit.residual[0])
    if np.max(np.abs(np.log(level / fit.observations.level))) < _CHANGED:
        return state
    scale = fit.observations.scale / fit.observations.level * level
    observations = replace(fit.observations, level=level, scale=scale)
    return state.with_(solve(evaluate(fit.chain, fit.free, observations, fit.weighting)))


def _levels(observations: Observations, residual: Array) -> Array:
    """Noise of each row's recording (n,) against the usual one, from the residual (n,) [rad].

    By second differences, which structure that is smooth from reading to reading leaves alone (J. von Neumann, Ann.
    Math. Statist. 12 (1941) 367). Rows that stand alone count too: among those of a quieter recording a louder one's
    would all seem to.
    """
    recordings = observations.motion.recordings
    assert recordings is not None
    sure = (residual[rows][observations.sure[rows]] for rows in recordings.slices)
    own = np.array([bounded_rms(np.diff(one, 2)) for one in sure])
    usual = float(np.median(own[recordings.number]))
    if usual == 0.0:
        return np.ones(len(observations))
    return np.asarray(np.clip(own / usual, _SMALLEST, 1.0 / _SMALLEST)[recordings.number])
