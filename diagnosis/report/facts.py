"""Plain facts of a sweep that an answer and a report state before anything is explained."""

from __future__ import annotations

from typing import Any

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.result import Discovery
from twin.angles import Array, wrap
from twin.motion import RPM
from twin.sweep import Sweep


def facts(found: Discovery) -> dict[str, Any]:
    """Directions, points a turn, speeds, temperatures, the error's RMS without its zero, what it is held against."""
    sweep, motion = found.sweep, found.sweep.motion()
    # Readings that single events have touched are left out, as they are of the baseline's figure beside this one.
    kept = ~found.masked if not found.masked.all() else np.ones_like(found.masked)
    said: dict[str, Any] = {
        "held_against": "given twin" if found.given is not None else "error model",
        "directions": int(np.unique(motion.direction).size),
        "points_per_turn": motion.points_per_turn,
        "error_rms_deg": float(np.sqrt(np.mean(angle_error_deg(found.baseline, sweep)[kept] ** 2))),
    }
    if np.any(motion.speed_rad_s != 0.0):
        rpm = np.abs(motion.speed_rad_s) / RPM
        said["speed_rpm"] = [float(rpm.min()), float(rpm.max())]
    if "temperature_c" in motion.columns:
        said["temperature_c"] = [float(motion.temperature_c.min()), float(motion.temperature_c.max())]
    return said


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
