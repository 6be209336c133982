"""Table 2 of the paper: the range and step of each factor, the four devices diagnosed, and cases drawn from the ranges.

The common scale of (Vx, Ax, Vy, Ay) cannot be seen in an angle. So a case is a point of the six visible parameters:
Vx/Ax, Vy/Ay, Ay/Ax, the phase, q = K1 mag / K2, and the zero, which the table lacks. The range of the phase, printed as
0.9/pi, is read as 0.9 deg: the printed devices are of that size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.error_model.model import Readings
from scenarios.commands.paper.table_1 import Q_PERCENT_PER_MT
from twin.angles import TAU, Array
from twin.chain import Chain
from twin.hall.gain_mismatch import GAIN_MISMATCH
from twin.hall.offset import OFFSET
from twin.hall.phase import PHASE
from twin.hall.quadratic_nonlinearity import QUADRATIC_NONLINEARITY

Q_PER_MT = 0.01 * Q_PERCENT_PER_MT
"""q = K1 mag / K2 for each millitesla."""
READINGS = 360
NOISE_DEG = 0.02
"""RMS noise of a drawn case."""
LARGEST_PHASE_RAD = float(np.radians(0.9))

FACTORS = ("Vx", "Ax", "Vy", "Ay", "Px", "Magx")
"""The columns of the table; offsets and amplitudes in V, the phase in rad, the field in mT."""
DEVICES = {
    "a": (0.008943, 1.008607, 0.000491, 0.994536, 0.000368, 113.0),
    "b": (0.005878, 1.000057, 0.007176, 0.995089, 0.001508, 135.0),
    "c": (0.007500, 0.993573, -0.006990, 1.003337, 0.003005, 71.0),
    "d": (0.007711, 0.994878, -0.003980, 0.992822, 0.002122, 110.0),
}
LOWEST = (-0.01, 0.99, -0.01, 0.99, -LARGEST_PHASE_RAD, 50.0)
HIGHEST = (0.01, 1.01, 0.01, 1.01, LARGEST_PHASE_RAD, 150.0)
STEPS: Array = np.array([1e-6, 1e-6, 1e-6, np.radians(9e-5), Q_PER_MT, 1e-6])
"""The steps in the visible parameters; the zero moves like the offsets."""


@dataclass(frozen=True, eq=False)
class Cases:
    """True points (cases, 6), reference and measured angles (cases, n) [rad]."""

    points: Array
    reference: Array
    measured: Array

    def __len__(self) -> int:
        return len(self.points)

    def part(self, rows: slice) -> Cases:
        """Some of the cases."""
        return Cases(self.points[rows], self.reference[rows], self.measured[rows])


def draw(cases: int, rng: np.random.Generator, *, readings: int = READINGS) -> Cases:
    """Devices drawn evenly from the ranges with any zero, measured once round with white noise."""
    factors = rng.uniform([*LOWEST, -np.pi], [*HIGHEST, np.pi], (cases, 7)).T
    points = np.stack([*visible(*factors[:6]), factors[6]], axis=-1)
    reference = np.tile(TAU * np.arange(readings) / readings, (cases, 1))
    x, y = Readings.of(reference, reference).channels(points)
    noise = np.radians(NOISE_DEG) * rng.standard_normal(reference.shape)
    return Cases(points, reference, np.arctan2(y, x) + noise)


def visible(*factors: Array | float) -> tuple[Array | float, ...]:
    """Vx/Ax, Vy/Ay, Ay/Ax, phase [rad] and q from the table's six factors."""
    vx, ax, vy, ay, beta, field = factors
    return vx / ax, vy / ay, ay / ax, beta, Q_PER_MT * field


def with_device(chain: Chain, name: str) -> Chain:
    """The chain with the factors of one of the table's devices."""
    offset_x, offset_y, ratio, beta, quad = visible(*DEVICES[name])
    return (
        chain.with_effect(OFFSET.name, x_percent=100.0 * float(offset_x), y_percent=100.0 * float(offset_y))
        .with_effect(GAIN_MISMATCH.name, ratio=float(ratio))
        .with_effect(PHASE.name, beta_deg=float(np.degrees(beta)))
        .with_effect(QUADRATIC_NONLINEARITY.name, q_percent=100.0 * float(quad))
    )
