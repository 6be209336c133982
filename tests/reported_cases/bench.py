"""The sensor of a reported case: two channels with small errors, an angle, a word; and the file it is written to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sensor:
    """Offsets (2,) and gain ratio as shares of the amplitude, phase [rad]; the noise of an angle [deg]."""

    offset: Array
    gain_ratio: float
    phase: float
    noise_deg: float

    def channels(self, angle: Array) -> Array:
        """Both channels, (2, n), of an angle (n,) [rad]."""
        cosine = np.cos(angle) + self.offset[0]
        sine = self.gain_ratio * np.sin(angle + self.phase) + self.offset[1]
        return np.stack([cosine, sine])

    def reading_deg(self, shaft_deg: Array, rng: np.random.Generator) -> Array:
        """What an unharmed sensor reads (n,) [deg], not wrapped to a turn of its own."""
        return self.angle_deg(self.channels(np.radians(shaft_deg)), rng)

    def angle_deg(self, channels: Array, rng: np.random.Generator) -> Array:
        """The angle of two channels, with noise."""
        return np.degrees(np.arctan2(channels[1], channels[0])) + self.noise_deg * rng.standard_normal(channels[0].size)


def some_sensor(rng: np.random.Generator, *, noise_deg: tuple[float, float] = (0.01, 0.1)) -> Sensor:
    """About 0.8 deg of order 1 and 0.3 deg of order 2."""
    size, around = np.radians(0.8 * rng.uniform(0.7, 1.3)), rng.uniform(0.0, 2.0 * np.pi)
    second, twist = np.radians(0.3 * rng.uniform(0.5, 1.5)), rng.uniform(0.0, 2.0 * np.pi)
    noise = float(np.exp(rng.uniform(*np.log(noise_deg))))
    return Sensor(
        size * np.array([np.cos(around), np.sin(around)]),
        1.0 + 2.0 * float(second * np.cos(twist)),
        2.0 * float(second * np.sin(twist)),
        noise,
    )


def a_turn(rng: np.random.Generator, *, points: int, turns: float = 1.0) -> Array:
    """Even steps of the shaft (points * turns,) [deg] from anywhere."""
    return np.arange(round(points * turns)) * (360.0 / points) + rng.uniform(0.0, 360.0)


def words(angle_deg: Array, bits: int) -> NDArray[np.int64]:
    """The nearest word of `bits` bits for an angle."""
    return np.mod(np.round(angle_deg * (2**bits / 360.0)), 2**bits).astype(np.int64)


@dataclass(frozen=True)
class Case:
    """Columns (n,) of a sweep file under their names, and what a right answer holds."""

    columns: Mapping[str, Array]
    truth: Mapping[str, float] = field(default_factory=dict)
    decimals: int = 6

    def write(self, path: Path) -> Path:
        """The sweep as CSV."""
        rows = np.column_stack(list(self.columns.values()))
        np.savetxt(path, rows, delimiter=",", header=",".join(self.columns), comments="", fmt=f"%.{self.decimals}f")
        return path


def case(shaft_deg: Array, measured_deg: Array, /, *, truth: Mapping[str, float] | None = None, **more: Array) -> Case:
    """A sweep of a reference and a reading, both wrapped to a turn, and further columns."""
    turned = {"reference_deg": np.mod(shaft_deg, 360.0), "measured_deg": np.mod(measured_deg, 360.0)}
    return Case({**turned, **more}, truth or {})
