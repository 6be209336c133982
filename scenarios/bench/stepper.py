"""The stepper drive: how long a motion takes, and where the shaft comes to stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import TAU
from twin.limits import require_within
from twin.motion import RPM
from twin.reference.encoder import stepper_order


@dataclass(frozen=True, kw_only=True)
class Stepper:
    """A two-phase stepper: full steps a turn, microsteps a full step, error of its stops [deg].

    The error is a sine over the electrical period of four full steps: unequal phase currents and the detent torque
    (Acarnley, Stepping Motors, section 1.6). Both encoders see it, since it is the shaft that stands elsewhere.
    """

    steps: int = 200
    microsteps: int = 256
    error_deg: float = 0.02
    acceleration_rpm_per_s: float = 600.0
    settle_s: float = 0.3

    def __post_init__(self) -> None:
        require_within("steps", self.steps, 4, 1e5, whole=True)
        require_within("microsteps", self.microsteps, 1, 4096, whole=True)
        require_within("error_deg", self.error_deg, 0.0, 360.0 / self.steps, "deg")
        require_within("acceleration", self.acceleration_rpm_per_s, 1.0, 65535.0, "rpm/s")
        require_within("settle time", self.settle_s, 0.0, 65.0, "s")

    def commanded(self, target_rad: float) -> float:
        """The microstep [rad] next to a target."""
        step = TAU / (self.steps * self.microsteps)
        return float(np.round(target_rad / step) * step)

    def stands(self, commanded_rad: float) -> float:
        """Where the shaft stands [rad] when the controller counts this angle."""
        period = stepper_order(self.steps)
        return float(commanded_rad + np.radians(self.error_deg) * np.sin(period * commanded_rad))

    def ramp_s(self, speed_rpm: float) -> float:
        """What getting up to this speed takes longer [s] than if the shaft had it at once."""
        return speed_rpm / self.acceleration_rpm_per_s / 2.0

    def duration(self, distance_rad: float, speed_rpm: float) -> float:
        """Time [s] of a motion from rest to rest: ramp up, constant speed, ramp down, settling."""
        acceleration, speed = self.acceleration_rpm_per_s * RPM, speed_rpm * RPM
        distance = abs(distance_rad)
        if distance < speed**2 / acceleration:
            return float(2.0 * np.sqrt(distance / acceleration)) + self.settle_s
        return float(distance / speed + speed / acceleration) + self.settle_s
