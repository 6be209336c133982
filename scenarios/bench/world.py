"""The one thing that the virtual nodes share beside the bus: the shaft, the clock and the air around them.

Time is simulated: it goes on when the shaft or the chamber does, never by itself, unless real time is asked for.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from scenarios.commands.coast import slowed
from twin.angles import Array
from twin.motion import RPM, Motion

SYNC_S = 1e-3
"""Simulated time between two latches in one place [s]."""
BUSY_S = 0.1
"""How often a node that is busy says so in real time [s]."""
BLOCK = 512
"""Poses that share one draw of random numbers: a reading keeps its noise when those after it are added."""
FRICTION_PER_S, DRY_AS_SPEED_RAD_S = 0.18, 100.0 * RPM
"""Friction of the shaft that is let go, a typical assumption: what grows with the speed slows it by so much a second,
and dry friction as that does at this speed. From 600 rpm to 60 takes 8 s."""
_COLUMNS = ("shaft_rad", "time_s", "direction", "speed_rad_s", "temperature_c")


@dataclass(eq=False)
class World:
    """The path of the shaft, one pose a stop or latch; all methods may be called from any thread."""

    real_time: bool = False
    temperature_c: float = 25.0
    _path: dict[str, Array] = field(default_factory=lambda: {name: np.zeros(BLOCK) for name in _COLUMNS})
    _poses: int = 0
    _latched: tuple[int, int] | None = None
    _fresh: bool = True
    _let_go: bool = False
    _lock: threading.RLock = field(default_factory=threading.RLock)

    def __post_init__(self) -> None:
        self._append(0.0, 0.0, 1.0, 0.0)

    @property
    def shaft_rad(self) -> float:
        """Where the shaft is."""
        with self._lock:
            return float(self._path["shaft_rad"][self._poses - 1])

    @property
    def speed_rad_s(self) -> float:
        """How fast it turns, signed."""
        with self._lock:
            return float(self._path["speed_rad_s"][self._poses - 1])

    @property
    def time_s(self) -> float:
        """Simulated time."""
        with self._lock:
            return float(self._path["time_s"][self._poses - 1])

    def turn_to(
        self, shaft_rad: float, duration_s: float, speed_rad_s: float = 0.0, *, busy: Callable[[], None]
    ) -> None:
        """Bring the shaft to an angle within a time; it arrives there with this speed."""
        self._wait(duration_s, busy)
        with self._lock:
            moved, self._let_go = shaft_rad - self.shaft_rad, False
            way = float(np.sign(moved)) if moved else float(self._path["direction"][self._poses - 1])
            self._append(shaft_rad, self.time_s + duration_s, way, speed_rad_s)

    def spin_up(self, speed_rad_s: float, duration_s: float, *, let_go: bool, busy: Callable[[], None]) -> None:
        """Bring the shaft to a speed within a time, evenly; then it is held there, or let go."""
        self._wait(duration_s, busy)
        with self._lock:
            angle = self.shaft_rad + 0.5 * (self.speed_rad_s + speed_rad_s) * duration_s
            way = float(np.sign(speed_rad_s)) if speed_rad_s else float(self._path["direction"][self._poses - 1])
            self._append(angle, self.time_s + duration_s, way, speed_rad_s)
            self._let_go = let_go

    def capture(self, period_s: float, count: int, *, busy: Callable[[], None]) -> slice:
        """The poses of so many readings, one a period, from now on: the shaft turns on evenly, or coasts."""
        self._wait(period_s * count, busy)
        with self._lock:
            first, began, speed = self._poses, self.time_s, self.speed_rad_s
            time: Array = period_s * np.arange(1, count + 1, dtype=np.float64)
            angles, speeds = speed * time, np.full(count, speed)
            if self._let_go:
                slowing = {"dry_as_rad_s": DRY_AS_SPEED_RAD_S, "rate_per_s": FRICTION_PER_S}
                angles, speeds = (np.sign(speed) * one for one in slowed(abs(speed), time, **slowing))
            way, from_rad = float(self._path["direction"][self._poses - 1]), self.shaft_rad
            for angle, at, now in zip(angles, time, speeds, strict=True):
                self._append(from_rad + float(angle), began + float(at), way, float(now))
            return slice(first, self._poses)

    def heat_to(self, temperature_c: float, duration_s: float, *, busy: Callable[[], None]) -> None:
        """Bring the air to a temperature within a time, the shaft at rest."""
        self._wait(duration_s, busy)
        with self._lock:
            self.temperature_c = temperature_c
            self._append(self.shaft_rad, self.time_s + duration_s, float(self._path["direction"][self._poses - 1]), 0.0)

    def latch(self, sequence: int) -> int:
        """The pose of a latch, the same for all who ask with one number; a second latch at rest is a bit later."""
        with self._lock:
            if self._latched is not None and self._latched[0] == sequence and not self._fresh:
                return self._latched[1]
            # In a passing motion the position compare has latched, once, and is read out as often as wanted.
            if not self._fresh and self.speed_rad_s == 0.0:
                self._append(self.shaft_rad, self.time_s + SYNC_S, float(self._path["direction"][self._poses - 1]), 0.0)
            self._fresh = False
            self._latched = (sequence, self._poses - 1)
            return self._poses - 1

    def motion(self, pose: int) -> tuple[Motion, int]:
        """The motion up to a pose, filled up to a whole block with poses after it, and the block's number.

        What fills up stands still where the pose is: effects are causal, and the shape of what they draw is fixed.
        """
        with self._lock:
            block = pose // BLOCK
            rows = np.minimum(np.arange((block + 1) * BLOCK), pose)
            path: dict[str, Any] = {name: values[rows] for name, values in self._path.items()}
        return (
            Motion(
                **path,
                turn=np.zeros(rows.size, dtype=np.int64),
                columns=frozenset({"time_s", "direction", "speed_rpm", "temperature_c", "vx"}),
            ),
            block,
        )

    def at(self, pose: int) -> dict[str, float]:
        """One pose, by the names of :class:`twin.motion.Motion`."""
        with self._lock:
            return {name: float(values[pose]) for name, values in self._path.items()}

    def swept(self, pose: int) -> tuple[float, float]:
        """The lowest and the highest shaft angle [rad] up to a pose."""
        with self._lock:
            path = self._path["shaft_rad"][: pose + 1]
            return float(path.min()), float(path.max())

    def _append(self, shaft_rad: float, time_s: float, direction: float, speed_rad_s: float) -> None:
        if self._poses == self._path["time_s"].size:
            self._path = {name: np.concatenate([values, np.zeros(values.size)]) for name, values in self._path.items()}
        row = (shaft_rad, time_s, direction, speed_rad_s, self.temperature_c)
        for name, value in zip(_COLUMNS, row, strict=True):
            self._path[name][self._poses] = value
        self._poses += 1
        self._fresh = True

    def _wait(self, duration_s: float, busy: Callable[[], None]) -> None:
        """In real time, wait; ``busy`` is called now and then meanwhile."""
        end = time.monotonic() + duration_s
        while self.real_time and (left := end - time.monotonic()) > 0.0:
            busy()
            time.sleep(min(left, BUSY_S))
