"""What these readings can tell of the six visible parameters: correlations, unseen combinations, limits, words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import least_squares, model
from diagnosis.error_model.model import ZERO, Readings
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors.profile_likelihood import Profile, profile
from diagnosis.factors.sentences import (
    TIED,
    said_of_any_sweep,
    said_of_few_readings,
    said_of_these_readings,
    said_of_weak_parameters,
)
from twin.angles import Array

_WEAK_SIGMA = 5.0
_UNSEEN = 1e-10
"""Smallest eigenvalue of the scaled information that rounding does not explain."""


@dataclass(frozen=True)
class Identifiability:
    """``correlations`` (6, 6); ``condition`` of the information scaled to a unit diagonal; the rest in words."""

    correlations: Array
    condition: float
    covered_deg: float
    unseen: tuple[tuple[float, ...], ...]
    """Combinations (6,) of parameters, each in its own standard units, that these readings do not see."""
    profiles: tuple[Profile, ...]
    sentences: tuple[str, ...]


def identifiability(
    fit: BaselineFit, reference_rad: Array, measured_rad: Array, *, has_channels: bool = False
) -> Identifiability:
    """What these readings (n,) can tell of the six visible parameters."""
    readings = Readings.of(
        reference_rad,
        measured_rad,
        sensor_sense=float(fit.senses.sensor),
        output_sense=float(fit.senses.output),
        weights=np.where(fit.outliers, 0.0, 1.0),
    )
    gram = readings.gram(fit.point)
    curvature = least_squares.on_gram(gram[None])(fit.point[None]).curvature[0]
    scale = np.sqrt(np.maximum(np.diagonal(curvature), 1e-300))
    values, vectors = np.linalg.eigh(curvature / scale[:, None] / scale)
    error = fit.standard_errors
    correlations = fit.covariance / error[:, None] / error
    unseen = tuple(tuple(map(float, vectors[:, k])) for k in np.flatnonzero(values < _UNSEEN * values[-1]))
    weak = _weak(fit, correlations)
    profiles = tuple(profile(fit, gram, int(index)) for index in np.flatnonzero(weak))
    covered = _covered(reference_rad[~fit.outliers])
    return Identifiability(
        correlations=correlations,
        condition=float(values[-1] / max(values[0], 1e-300)),
        covered_deg=covered,
        unseen=unseen,
        profiles=profiles,
        sentences=(
            *said_of_any_sweep(fit, has_channels),
            *said_of_these_readings(covered, unseen, correlations),
            *said_of_few_readings(fit),
            *said_of_weak_parameters(fit, profiles),
        ),
    )


def _weak(fit: BaselineFit, correlations: Array) -> NDArray[np.bool_]:
    """Parameters (6,) whose interval may be lopsided: hardly different from none, or nearly tied to another."""
    away = np.abs(fit.point - model.NOMINAL) / np.maximum(fit.standard_errors, 1e-300)
    away[ZERO] = np.inf
    tied = (np.abs(correlations - np.eye(6)) > TIED).any(axis=1)
    return (away < _WEAK_SIGMA) | tied


def _covered(reference_rad: Array) -> float:
    """How much of the circle the readings cover [deg]: 360 less the widest gap, plus one usual step."""
    angles = np.sort(np.remainder(reference_rad, 2.0 * np.pi))
    gaps = np.diff(np.concatenate([angles, angles[:1] + 2.0 * np.pi]))
    moved = gaps[gaps > 1e-4]
    usual = float(np.median(moved)) if moved.size else 0.0
    return float(np.degrees(min(2.0 * np.pi - gaps.max() + usual, 2.0 * np.pi)))
