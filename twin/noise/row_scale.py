"""How the RMS of the noise depends on the conditions of a reading: direction, temperature, speed, place in the turn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from twin.angles import TAU, Array
from twin.motion import NOMINAL_C, Motion

_RPM = 60.0 / TAU


def conditions(motion: Motion, angle_rad: Array) -> dict[str, Array]:
    """What the logarithm of the RMS may be proportional to: rows (terms, n) by the name of their parameter.

    Zero throughout for readings in forward direction at 25 C and standstill, but for the angle's two terms.
    """
    return {
        "backward_percent": np.where(motion.direction < 0.0, 1.0, 0.0)[None],
        "percent_per_K": (motion.temperature_c - NOMINAL_C)[None],
        "percent_per_rpm": (_RPM * np.abs(motion.speed_rad_s))[None],
        "angle_percent": np.stack([np.cos(angle_rad), np.sin(angle_rad)]),
    }


@dataclass(frozen=True, kw_only=True)
class RowScale:
    """RMS of a reading against that of a reading in forward direction at 25 C and standstill.

    Attributes
    ----------
    backward_percent : float
        More in backward direction [%].
    percent_per_K, percent_per_rpm : float
        More with each kelvin above 25 C and with each rpm of speed, compounding [%/K, %/rpm].
    angle_percent, angle_phase_deg : float
        More at the sensor angle ``angle_phase_deg`` [deg] than in the mean over a turn, and as much less (by the same
        factor) on the opposite side [%].
    """

    backward_percent: float = 0.0
    percent_per_K: float = 0.0
    percent_per_rpm: float = 0.0
    angle_percent: float = 0.0
    angle_phase_deg: float = 0.0

    @property
    def even(self) -> bool:
        """Whether all readings scatter alike."""
        return not any((self.backward_percent, self.percent_per_K, self.percent_per_rpm, self.angle_percent))

    def of(self, motion: Motion, angle_rad: Array) -> Array:
        """Relative RMS (..., n) of readings at sensor angles (..., n) [rad]."""
        terms = conditions(motion, angle_rad)
        log_scale = np.zeros_like(angle_rad)
        for name in ("backward_percent", "percent_per_K", "percent_per_rpm"):
            log_scale = log_scale + np.log1p(0.01 * getattr(self, name)) * terms[name][0]
        phase = np.radians(self.angle_phase_deg)
        cos, sin = terms["angle_percent"]
        log_scale = log_scale + np.log1p(0.01 * self.angle_percent) * (cos * np.cos(phase) + sin * np.sin(phase))
        return np.asarray(np.exp(log_scale))

    @classmethod
    def from_slopes(cls, slopes: Mapping[str, Array]) -> RowScale:
        """The scale whose logarithm has these slopes (terms,) on the :func:`conditions`; those not given are zero."""
        percent = {
            name: 100.0 * float(np.expm1(np.hypot.reduce(slope) if slope.size > 1 else slope[0]))
            for name, slope in slopes.items()
        }
        phase = {}
        if "angle_percent" in slopes:
            cos, sin = slopes["angle_percent"]
            phase["angle_phase_deg"] = float(np.degrees(np.arctan2(sin, cos)))
        return cls(**percent, **phase)
