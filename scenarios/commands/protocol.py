"""Motions that a bench would run: turns in steps or at speed, in one direction or both, at several temperatures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from twin.angles import TAU
from twin.limits import OutOfRangeError, require_within
from twin.motion import Motion
from twin.shown import shown

COLDEST_C, HOTTEST_C = -100.0, 300.0
"""Between these a magnet and a sensor are what their figures say."""
MOST_READINGS = 10_000_000
"""More are more than memory holds with every signal on its way."""
STOP_S = 0.5
"""Time from one stop to the next in a stop-and-measure run [s]."""


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """``turns`` turns of ``points`` readings each, at every speed and temperature; speed 0 is stop-and-measure."""

    turns: int = 1
    points: int = 360
    both_directions: bool = False
    speeds_rpm: Sequence[float] = (0.0,)
    temperatures_c: Sequence[float] = ()
    channels: bool = True

    def __post_init__(self) -> None:
        require_within("turns", self.turns, 1, 1e5, whole=True)
        require_within("points", self.points, 8, 1e6, whole=True)
        require_within("speed-rpm", list(self.speeds_rpm), 0.0, 1e5, "rpm")
        require_within("temperatures", list(self.temperatures_c), COLDEST_C, HOTTEST_C, "C")
        require_within("readings (turns, points, directions, speeds, temperatures)", self.rows, 8, MOST_READINGS)

    @property
    def rows(self) -> int:
        """Readings of the whole run."""
        legs = (1 + self.both_directions) * len(self.speeds_rpm) * max(len(self.temperatures_c), 1)
        return self.turns * self.points * legs

    def motion(self) -> Motion:
        """The motion, one leg after the other; the shaft goes back over the same angles in the second direction."""
        steps = np.arange(self.turns * self.points)
        one = TAU / self.points * steps
        ways = (1.0, -1.0) if self.both_directions else (1.0,)
        legs: list[dict[str, Any]] = []
        clock = 0.0
        for temperature in self.temperatures_c or (25.0,):
            for rpm in self.speeds_rpm:
                interval = STOP_S if rpm == 0.0 else 60.0 / rpm / self.points
                for way in ways:
                    legs.append(
                        {
                            "shaft_rad": one if way > 0 else one[::-1],
                            "time_s": clock + interval * steps,
                            "direction": np.full(steps.size, way),
                            "speed_rad_s": np.full(steps.size, way * rpm * TAU / 60.0),
                            "turn": len(legs) * self.turns + steps // self.points,
                            "temperature_c": np.full(steps.size, temperature),
                        }
                    )
                    clock += interval * steps.size + STOP_S
        unknown = {"speed_rad_s": not any(self.speeds_rpm), "temperature_c": not self.temperatures_c}
        columns: dict[str, Any] = {
            name: None if unknown.get(name) else np.concatenate([leg[name] for leg in legs]) for name in legs[0]
        }
        return Motion.from_angle(**columns, has_channels=self.channels)


def numbers(name: str, text: str) -> list[float]:
    """Comma-separated numbers. Raises OutOfRangeError for anything else."""
    try:
        return [float(part) for part in text.split(",") if part.strip()]
    except ValueError:
        raise OutOfRangeError(f"{name} is {shown(text)}; expected numbers with commas between, e.g. 25,60") from None
