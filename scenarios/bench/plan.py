"""The plan of a measurement: which angles, from which side, how often, how fast, how warm."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property

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
    """One reading to take. ``angle_deg`` counts over turns; at ``speed_rpm`` 0 the shaft stops, else it passes by."""

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
        turns = self.legs * self.turns
        if turns * self.points + 2 * self.legs > MOST_READINGS or turns > MOST_TURNS:
            raise UserError(
                f"plan: {turns * self.points} readings in {turns} turns; "
                f"expected at most {MOST_READINGS} and {MOST_TURNS}: measure several sweeps"
            )

    @property
    def legs(self) -> int:
        """Stretches of one direction, speed and temperature."""
        return (1 + self.both_directions) * len(self.speeds_rpm) * max(len(self.temperatures_c), 1)

    @cached_property
    def readings(self) -> int:
        """Readings in all."""
        return sum(1 for _ in self.stops())

    def stops(self) -> Iterator[Stop]:
        """The readings in order.

        In one direction the shaft goes ever on; the way back goes over the same angles. Angles that are passed have a
        stop before and behind them, where the shaft speeds up and slows down: so the sweep holds every reversal,
        and with it the path that a hysteresis depends on.
        """
        index, offset, at, before = 0, 0.0, 0.0, 0
        for leg, (temperature, speed, way) in enumerate(self._legs()):
            ramp = self.ramp_deg(speed)
            if way == before:
                offset += 360.0 * math.ceil((at + ramp - offset) / 360.0)
            angles = [offset + 360.0 * k / self.points for k in range(self.turns * self.points)][::way]
            listed = [(angle, way, leg * self.turns + k // self.points, speed) for k, angle in enumerate(angles)]
            if ramp:
                up, out = angles[0] - way * ramp, angles[-1] + way * ramp
                if not before or up != at:
                    listed.insert(0, (up, way if not before else int(math.copysign(1, up - at)), listed[0][2], 0.0))
                listed.append((out, way, listed[-1][2], 0.0))
            for angle, direction, turn, rpm in listed:
                yield Stop(index, angle, direction, turn, rpm, temperature)
                index += 1
            at, before = listed[-1][0], way

    def _legs(self) -> Iterator[tuple[float | None, float, int]]:
        """Temperature, speed and direction of each leg."""
        ways = (1, -1) if self.both_directions else (1,)
        return itertools.product(self.temperatures_c or (None,), self.speeds_rpm, ways)

    def run_in_deg(self, first: Stop) -> list[float]:
        """The angles to drive to one after the other before a reading, which may be any of the plan.

        They lead over as much of the way to it as the concentrator remembers, with every reversal there: a run that
        goes on behind a reversal finds the field that an undisturbed one has there.
        """
        stops = list(itertools.islice(self.stops(), first.index + 1))
        begin = stops[0].angle_deg - stops[0].direction * max(RUN_IN_DEG, self.ramp_deg(stops[0].speed_rpm))
        way = [first.angle_deg]
        left, heading = max(RUN_IN_DEG, self.ramp_deg(first.speed_rpm)), 0.0
        for before in [*(stop.angle_deg for stop in stops[-2::-1]), begin]:
            if left <= 0.0:
                break
            step = way[-1] - before
            if step * heading > 0.0:
                way.pop()
            if step:
                left -= abs(step)
                heading = step
                way.append(before)
        if max(way) - min(way) < 360.0:
            # Over less than a turn to and fro the reference may not pass its index: begin farther back.
            way[-1] -= math.copysign(RUN_IN_DEG, heading)
        return way[:0:-1]

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
