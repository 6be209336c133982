"""Readings repeated at one angle are one angle measured several times: intervals follow the scatter between angles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.error_model.result import BaselineFit
from twin.angles import Array
from twin.confidence import student_95

_SAME_DEG = 1e-4
_FEWEST_REPEATS = 2.0
_PARAMETERS = 6


def between_angles(fit: BaselineFit, reference_deg: Array) -> tuple[BaselineFit, str | None]:
    """The fit with intervals from the scatter between angles, and a sentence; both unchanged where nothing repeats.

    Where the readings of an angle scatter less than the angles do, the mean residual of each angle is what counts:
    the variance of a reading is then sum n_g mean_g^2 / (angles - 6), never less than under independence.
    """
    used = ~fit.outliers
    _, group = np.unique(np.round(np.remainder(reference_deg[used], 360.0) / _SAME_DEG), return_inverse=True)
    count = np.bincount(group)
    angles = count.size
    if angles <= _PARAMETERS + 1 or used.sum() < _FEWEST_REPEATS * angles:
        return fit, None
    mean = np.bincount(group, weights=fit.residual_rad[used]) / count
    between = float(np.sqrt(np.sum(count * mean**2) / (angles - _PARAMETERS)))
    if between <= fit.sigma_rad:
        return fit, None
    covariance = fit.covariance * (between / fit.sigma_rad) ** 2
    freedom = angles - _PARAMETERS
    half = student_95(freedom) * np.sqrt(np.diagonal(covariance))
    words = (
        f"{angles} different angles, {np.mean(count):.0f} readings each: the intervals count angles, not readings "
        f"({between / fit.sigma_rad:.1f} times wider)"
    )
    wider = replace(fit, covariance=covariance, low=fit.point - half, high=fit.point + half, degrees_of_freedom=freedom)
    return wider, words
