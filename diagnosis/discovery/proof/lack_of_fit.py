"""Lack of fit: what a fit leaves of the rows' means, against what the scatter of repeated readings explains of it.

The F test of lack of fit against pure error: Draper and Smith, Applied Regression Analysis, 3rd ed., section 2.1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit


@dataclass(frozen=True)
class LackOfFit:
    """``p``: how often repeated readings' scatter alone leaves so much; ``ratio``: the mean squares' (F).

    ``left_deg`` is the RMS that the fit leaves of the means, ``by_scatter_deg`` what the scatter explains of it;
    ``row`` is the row of the fit that lies farthest off.
    """

    p: float
    ratio: float
    left_deg: float
    by_scatter_deg: float
    row: int


def lack_of_fit(fit: Fit, *, step_rad: float) -> LackOfFit | None:
    """Hold a fit against the repeats among its readings; None where it has none, or no row beyond its parameters.

    The output's rounding, ``step_rad`` (0: none), is the same for readings of one angle, and counts to what is known.
    """
    from scipy.special import fdtrc

    observations = fit.observations
    repeats = observations.repeats
    rows = np.flatnonzero(observations.usable)
    freedom = rows.size - len(fit.free)
    if repeats is None or freedom < 1:
        return None
    within = float(np.sum(repeats.freedom[rows]))
    variance = repeats.variance_of_means(rows) + step_rad**2 / 12.0 if within > 0.0 else np.zeros(rows.size)
    if not np.all(variance > 0.0):
        return None
    left = fit.residual[0][rows]
    ratio = float(np.sum(left**2 / variance)) / freedom
    return LackOfFit(
        p=float(fdtrc(freedom, within, ratio)),
        ratio=ratio,
        left_deg=float(np.degrees(np.sqrt(np.sum(left**2) / freedom))),
        by_scatter_deg=float(np.degrees(np.sqrt(np.mean(variance)))),
        row=int(rows[np.argmax(left**2 / variance)]),
    )
