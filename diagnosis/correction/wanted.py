"""What a drive's table is to hold: the correction at one temperature, in the sense in which the sensor counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.correction.compensation import Correction
from diagnosis.thermal.laws import FROM_C
from twin.angles import TAU, Array, wrap

_GRID = 8192


@dataclass(frozen=True, eq=False)
class Wanted:
    """shaft angle = slope (m + added(m)) - zero, at one temperature [C]; ``added`` has no mean over the turn."""

    slope: int
    zero_rad: float
    correction: Correction
    temperature_c: float

    @classmethod
    def of(cls, correction: Correction, temperature_c: float = FROM_C) -> Wanted:
        """What a correction is at a temperature; beyond the span that it follows, what it is at the nearer end."""
        grid = TAU * np.arange(_GRID) / _GRID
        away = correction.shaft(grid, temperature_c) - correction.slope * grid
        return cls(correction.slope, -float(np.angle(np.mean(np.exp(1j * away)))), correction, temperature_c)

    def shaft(self, reading_rad: Array) -> Array:
        """Shaft angle [rad] of readings of any shape, in [-pi, pi)."""
        return self.correction.shaft(reading_rad, self.temperature_c)

    def added(self, reading_rad: Array) -> Array:
        """What is to be added to readings [rad] of any shape, in the sensor's own sense."""
        reading = np.asarray(reading_rad, dtype=np.float64)
        return self.slope * wrap(self.shaft(reading) - self.slope * reading + self.zero_rad)

    def from_added(self, corrected_rad: Array) -> Array:
        """Shaft angle [rad] of readings to which a drive has added its correction."""
        return wrap(self.slope * np.asarray(corrected_rad) - self.zero_rad)
