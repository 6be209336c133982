"""Plain facts of a sweep that an answer and a report state before anything is explained."""

from __future__ import annotations

from typing import Any

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.result import Discovery
from twin.angles import Array, wrap
from twin.motion import AT_ONE_ANGLE_RAD, RPM, Motion
from twin.sweep import Sweep

TIME_AND_REFERENCE = "time_s and reference_deg"
"""What tells the speed where no speed was recorded, and the stamps are those of a shaft in motion."""


def facts(found: Discovery) -> dict[str, Any]:
    """Directions, points a turn, speeds, temperatures, the error's RMS without its zero, what it is held against."""
    sweep, motion = found.sweep, found.sweep.motion()
    # Readings that single events have touched are left out, as they are of the baseline's figure beside this one.
    kept = ~found.masked if not found.masked.all() else np.ones_like(found.masked)
    said: dict[str, Any] = {
        "held_against": "given twin" if found.given is not None else "error model",
        "directions": int(np.unique(motion.direction).size),
        "points_per_turn": motion.points_per_turn,
        "step_deg": _steps_deg(motion),
        "error_rms_deg": float(np.sqrt(np.mean(angle_error_deg(found.baseline, sweep)[kept] ** 2))),
    }
    if np.any(motion.speed_rad_s != 0.0):
        rpm = np.abs(motion.speed_rad_s) / RPM
        said["speed_rpm"] = [float(rpm.min()), float(rpm.max())]
        said["speed_from"] = _speed_from(sweep, motion)
    if "temperature_c" in motion.columns:
        said["temperature_c"] = [float(motion.temperature_c.min()), float(motion.temperature_c.max())]
    return said


_ESTIMATED = ("reference_deg", "direction", "speed_rpm")
"""Columns of a sweep that hold what was estimated where no reference was recorded."""


def recorded_columns(sweep: Sweep) -> list[str]:
    """Names of the columns that were recorded."""
    return [name for name in sweep.columns if sweep.estimated is None or name not in _ESTIMATED]


def _steps_deg(motion: Motion) -> list[float]:
    """Shortest and longest step [deg] from one angle to the next, a twentieth of all beyond either left out."""
    step = np.abs(np.diff(motion.shaft_rad))
    onward = step[step > AT_ONE_ANGLE_RAD]
    return np.degrees(np.quantile(onward, [0.05, 0.95])).tolist() if onward.size else [0.0, 0.0]


def _speed_from(sweep: Sweep, motion: Motion) -> str:
    """The columns, or the estimate, that tell how fast the shaft turned."""
    if sweep.estimated is not None:
        return "estimated motion"
    return "speed_rpm" if "speed_rpm" in motion.columns else TIME_AND_REFERENCE


def angle_error_deg(fit: Fit, sweep: Sweep) -> Array:
    """Reading minus reference [deg] (n,) in the sense that the two count together, without its mean.

    Each of several recordings has a zero, and so a mean, of its own.
    """
    slope = fit.chain.sensor_sense * fit.chain.output_sense
    error = np.radians(sweep.measured_deg - slope * sweep.reference_deg)
    if sweep.recordings is not None:
        return np.concatenate([_without_mean_deg(error[rows]) for rows in sweep.recordings.slices])
    return _without_mean_deg(error)


def as_sent_deg(found: Discovery) -> Array | None:
    """Error of the words as they were sent [deg] (n,), without its mean; None where all readings are as they were."""
    if found.told_back is None:
        return None
    error = angle_error_deg(found.baseline, found.sweep) + np.degrees(found.told_back)
    return np.asarray(error - np.mean(error))


def _without_mean_deg(error: Array) -> Array:
    """Angles [rad] (n,) without their mean, in degrees."""
    centre = np.angle(np.mean(np.exp(1j * error)))
    away = wrap(error - centre)
    return np.asarray(np.degrees(away - np.mean(away)))
