"""The readings that the fits were made of, and how large errors are over them: what a share of the error is taken of.

Readings that stand alone, that single events have touched, or whose direction is in doubt are none of these.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.marks.row_masks import raw_residual
from diagnosis.discovery.result import Discovery
from diagnosis.report.facts import angle_error_deg, as_sent_deg
from twin.effect import BoolArray


def fitted(found: Discovery) -> BoolArray:
    """Which of the readings (n_raw,) the fits were made of."""
    observations = found.fit.observations
    rows = observations.usable[observations.group] & ~found.masked
    return rows if rows.any() else np.ones_like(rows)


def wild(found: Discovery) -> BoolArray:
    """Which readings (n_raw,) stand alone far out of their neighbours, and no cause has claimed them."""
    observations = found.fit.observations
    alone = (observations.sure & ~observations.usable)[observations.group]
    return alone & ~found.masked & ~fitted(found)


def counts(found: Discovery) -> dict[str, int]:
    """How many readings were fitted, and how many were not although they are in use; all of them with the wild ones."""
    left_out = ~fitted(found)
    touched = left_out & found.masked
    rest = left_out & ~touched & ~wild(found)
    named = {"fitted": ~left_out, "touched": touched, "direction_in_doubt": rest}
    return {name: int(np.count_nonzero(rows)) for name, rows in named.items()}


def of_baseline(found: Discovery) -> dict[str, Any]:
    """The error without its mean, what the baseline leaves [deg RMS], and the share of the mean square it explains."""
    rows = fitted(found)
    error_deg = angle_error_deg(found.baseline, found.sweep)[rows]
    before = float(np.std(error_deg))
    after = rms_deg(found, found.baseline)
    sent = as_sent_deg(found)
    return {
        **({} if sent is None else {"as_sent_error_rms_deg": float(np.std(sent[rows]))}),
        "fitted_error_rms_deg": before,
        "fitted_rms_deg": after,
        "explained_percent": 100.0 * (1.0 - (after / before) ** 2) if before > 0.0 else None,
    }


def rms_deg(found: Discovery, fit: Fit) -> float:
    """What a fit leaves of these readings [deg RMS]."""
    return float(np.degrees(np.sqrt(np.mean(raw_residual(fit, found.sweep)[fitted(found)] ** 2))))
