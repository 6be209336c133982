"""time_jitter: the instant of a reading is uncertain, and the angle by how far the shaft goes meanwhile."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.found_by import OverSpeed
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    if rng is None:
        return signal
    late_s = 1e-6 * np.asarray(values["rms_us"]) * rng.standard_normal(signal.shape)
    return np.asarray(signal + motion.speed_rad_s * late_s)


def spread(speed_rad_s: Array, values: Parameters) -> Array:
    """Variance (n,) [rad^2] added at the shaft's speed (n,): the square of speed times uncertainty."""
    return np.asarray((1e-6 * np.asarray(values["rms_us"]) * speed_rad_s) ** 2)


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """Strength: the RMS at the highest speed."""
    fastest = max(float(np.max(np.abs(motion.speed_rad_s))), 1e-9)
    return {"rms_us": 1e6 * radians(strength_deg) / fastest}


TIME_JITTER = Effect(
    name="time_jitter",
    stage="link",
    acts_on="shaft",
    params={
        "rms_us": Param(
            unit="us",
            null=0.0,
            lower=0.0,
            upper=1e5,
            doc="RMS of the instant of a reading",
            role="random",
            typical=10.0,
        )
    },
    forward=forward,
    needs=frozenset({"two speeds"}),
    footprint="spread",
    spread=OverSpeed(spread),
    drawing=drawing,
    source="aperture uncertainty: error = slope times uncertainty, IEEE Std 1241, section 4.9 (aperture uncertainty)",
    signature="noise whose RMS follows the speed",
)
