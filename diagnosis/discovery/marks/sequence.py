"""Sequence: single readings that an effect of the link has touched, told by their values and their neighbours."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise.rounding import coarsest_stair
from diagnosis.discovery.marks.outliers import local_rms
from diagnosis.discovery.marks.row_masks import raw_residual
from twin.effect import BoolArray, Effect
from twin.sweep import Sweep


def touched_rows(
    fit: Fit, sweep: Sweep, effect: Effect, *, step: float, spoken_for: BoolArray, family: int
) -> tuple[BoolArray, Finding] | None:
    """Raw rows (n_raw,) that the effect has touched, and the effect as a cause; None where chance explains them.

    ``step`` [rad] is that of the output's grid; rows ``spoken_for`` (n_raw,) belong to another effect already;
    ``family`` is the number of effects that are looked for in the sequence.
    """
    assert effect.marks is not None
    residual = np.where(spoken_for, 0.0, raw_residual(fit, sweep))
    # What a CORDIC's uneven stairs leave stands out of the noise too.
    stairs = coarsest_stair(fit.chain) / np.sqrt(12.0)
    scale = fit.observations.scale[fit.observations.group]
    # Where the noise is louder a reading has to do more to be no noise.
    sigma = (
        np.maximum(local_rms(residual / scale) * scale, stairs) if np.ptp(scale) else max(local_rms(residual), stairs)
    )
    mask, log_p = effect.marks(np.radians(sweep.measured_deg), residual, sigma, step, sweep.motion())
    if log_p > fit.settings.effect_log_p(family) or not mask.any():
        return None
    rows = tuple(int(row) for row in np.flatnonzero(mask))
    return mask, Finding.among(family, effect.name, log_p, gain=-2.0 * log_p, rows=rows)
