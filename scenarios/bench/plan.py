"""The plan of a measurement: which angles, from which side, how often, how fast, how warm."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from scenarios.bench.messages import FASTEST_RPM, SPEED_STEP_RPM
from twin.errors import UserError
from twin.limits import require_within

MOST_READINGS = 1 << 16
MOST_TURNS = 1 << 12
"""What the labels of a Sync can count."""
RUN_IN_DEG = 400.0
"""Travel before the first reading: the reference passes its index, the concentrator forgets where it came from."""


@dataclass(frozen=True)
class Stop:
    """One reading to take. ``angle_deg`` counts over turns; ``speed_rpm`` 0 is a stop, else the angle is passed."""

    index: int
    angle_deg: float
    direction: int
    turn: int
    speed_rpm: float
    temperature_c: float | None


@dataclass(frozen=True, kw_only=True)
class Plan:
    """``turns`` turns of ``points`` readings, in one direction or there and back, at every speed and temperature."""

    points: int = 360
    turns: int = 1
    both_directions: bool = False
    speeds_rpm: Sequence[float] = (0.0,)
    temperatures_c: Sequence[float] = ()
    settle_s: float = 0.3
    drive_rpm: float = 60.0
    acceleration_rpm_per_s: float = 600.0

    def __post_init__(self) -> None:
        require_within("points", self.points, 8, MOST_READINGS, whole=True)
        require_within("turns", self.turns, 1, MOST_TURNS, whole=True)
        require_within("speed-rpm", list(self.speeds_rpm), 0.0, FASTEST_RPM, "rpm")
        require_within("drive-rpm", self.drive_rpm, SPEED_STEP_RPM, FASTEST_RPM, "rpm")
        require_within("temperatures", list(self.temperatures_c), -100.0, 300.0, "C")
        require_within("settle time", self.settle_s, 0.0, 65.0, "s")
        require_within("acceleration", self.acceleration_rpm_per_s, 1.0, 65535.0, "rpm/s")
        for speed in (*self.speeds_rpm, self.drive_rpm):
            if speed % SPEED_STEP_RPM:
                raise UserError(f"speed {speed:g} rpm: the drive's command counts in steps of {SPEED_STEP_RPM:g} rpm")
        if self.readings > MOST_READINGS or self.legs * self.turns > MOST_TURNS:
            raise UserError(
                f"plan: {self.readings} readings in {self.legs * self.turns} turns; "
                f"expected at most {MOST_READINGS} and {MOST_TURNS}: measure several sweeps"
            )

    @property
    def legs(self) -> int:
        """Stretches of one direction, speed and temperature."""
        return (1 + self.both_directions) * len(self.speeds_rpm) * max(len(self.temperatures_c), 1)

    @property
    def readings(self) -> int:
        """Readings in all."""
        return self.legs * self.turns * self.points

    def stops(self) -> Iterator[Stop]:
        """The readings in order; the way back goes over the same angles."""
        index = leg = 0
        angles = [360.0 * k / self.points for k in range(self.turns * self.points)]
        for temperature in self.temperatures_c or (None,):
            for speed in self.speeds_rpm:
                for way in (1, -1) if self.both_directions else (1,):
                    for place, angle in enumerate(angles if way > 0 else angles[::-1]):
                        turn = leg * self.turns + place // self.points
                        yield Stop(index, angle, way, turn, speed, temperature)
                        index += 1
                    leg += 1

    def run_in_deg(self, first: Stop) -> float:
        """The angle to start from, so that the first reading is approached as those after it."""
        return first.angle_deg - first.direction * RUN_IN_DEG

    def ramp_deg(self, speed_rpm: float) -> float:
        """Travel between standstill and this speed, with a margin: 6 deg/s is one turn a minute."""
        return 0.0 if speed_rpm == 0.0 else 1.2 * 6.0 * speed_rpm**2 / (2.0 * self.acceleration_rpm_per_s) + 1.0

    def digest(self) -> str:
        """A short name of this plan: a journal of another one is not continued."""
        content = {key: list(v) if isinstance(v, tuple | list) else v for key, v in asdict(self).items()}
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def resolution_deg(target_deg: float) -> float:
    """A target as the bus carries it."""
    return float(np.round(target_deg, 3))
