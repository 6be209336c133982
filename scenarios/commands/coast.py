"""A shaft let go at speed: how it slows under friction, sampled as a logger does that has no reference."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from math import log1p

import numpy as np

from scenarios.commands.protocol import MOST_READINGS
from twin.angles import Array
from twin.errors import UserError
from twin.limits import OutOfRangeError, require_within
from twin.motion import RPM, Motion
from twin.pace import STOP_AND_MEASURE_S

OPTIONS = {
    "start_rpm": "--start-rpm",
    "stop_rpm": "--stop-rpm",
    "time_s": "--coast-time",
    "dry_share": "--dry-share",
    "rate_Hz": "--rate",
}
"""What each figure of a coast is called on the command line."""
READINGS_A_TURN = 4
"""At the start speed, at least: two leave open which way the shaft turns."""


@dataclass(frozen=True, kw_only=True)
class Coast:
    """From ``start_rpm`` to ``stop_rpm`` in ``time_s``, under dry friction and friction that grows with the speed.

    ``dry_share`` of the friction at the start speed is dry; without a stop speed, a tenth of the start speed.
    """

    start_rpm: float = 3000.0
    stop_rpm: float | None = None
    time_s: float = 5.0
    dry_share: float = 0.5
    rate_Hz: float = 2000.0
    channels: bool = False

    def __post_init__(self) -> None:
        require_within("start-rpm", self.start_rpm, 0.1, 1e5, "rpm")
        require_within("dry-share", self.dry_share, 0.0, 1.0)
        require_within("coast-time", self.time_s, 0.01, 1e5, "s")
        require_within("rate", self.rate_Hz, 1.0 / STOP_AND_MEASURE_S, 1e6, "Hz")
        if self.stop_rpm is not None and not 0.0 <= self.stop_rpm < self.start_rpm:
            raise OutOfRangeError(
                f"stop-rpm is {self.stop_rpm:g} rpm; expected from 0 to below the start speed of {self.start_rpm:g} rpm"
            )
        if self.dry_share == 0.0 and self.stop_rpm == 0.0:
            raise OutOfRangeError("stop-rpm is 0 rpm; without dry friction no shaft stops: give a dry-share above 0")
        least = READINGS_A_TURN * self.start_rpm / 60.0
        if self.rate_Hz < least:
            raise OutOfRangeError(
                f"rate is {self.rate_Hz:g} Hz; expected at least {least:g} Hz, {READINGS_A_TURN} readings a turn at "
                f"{self.start_rpm:g} rpm"
            )
        require_within("readings (coast-time times rate)", self.rows, 8, MOST_READINGS)

    @property
    def rows(self) -> int:
        """Readings of the whole coast."""
        return int(self.time_s * self.rate_Hz)

    def motion(self) -> Motion:
        """The motion, time alone recorded beside the angle."""
        time = np.arange(self.rows) / self.rate_Hz
        angle, speed = self._at(time)
        return replace(
            Motion.from_angle(angle, time_s=time, has_channels=self.channels),
            speed_rad_s=speed,
        )

    def _at(self, time: Array) -> tuple[Array, Array]:
        """Angle [rad] and speed [rad/s] (n,): what solves dw/dt = -(c + v w) from start to stop speed in the time."""
        start = self.start_rpm * RPM
        stop = 0.1 * start if self.stop_rpm is None else self.stop_rpm * RPM
        if self.dry_share == 1.0:
            slowing = (start - stop) / self.time_s
            return time * (start - 0.5 * slowing * time), start - slowing * time
        # c / v, from the shares at the start; v then from the time.
        level = start * self.dry_share / (1.0 - self.dry_share)
        rate = log1p((start - stop) / (stop + level)) / self.time_s
        return slowed(start, time, dry_as_rad_s=level, rate_per_s=rate)


def slowed(start_rad_s: float, time_s: Array, *, dry_as_rad_s: float, rate_per_s: float) -> tuple[Array, Array]:
    """Angle [rad] and speed [rad/s] (n,) of a shaft let go at a speed, until it stands.

    Friction that grows with the speed slows it by ``rate_per_s`` of it, dry friction as that does at ``dry_as_rad_s``:
    dw/dt = -rate (w + dry).
    """
    stands = np.inf if dry_as_rad_s == 0.0 else log1p(start_rad_s / dry_as_rad_s) / rate_per_s
    gone = rate_per_s * np.minimum(time_s, stands)
    fallen = -np.expm1(-gone)
    angle = (start_rad_s * fallen - dry_as_rad_s * _less_its_slope(gone)) / rate_per_s
    return angle, start_rad_s - (start_rad_s + dry_as_rad_s) * fallen


def _less_its_slope(x: Array) -> Array:
    """x - (1 - exp(-x)) for x of 0 or more, by its series where the difference would cancel."""
    return np.where(x < 1e-3, x * x * (0.5 - x * (1.0 - 0.25 * x) / 6.0), x + np.expm1(-x))


def refuse_protocol(given: Mapping[str, bool]) -> None:
    """A coast is a motion of its own. Raises UserError where an option was given that asks for another."""
    for name, asked in given.items():
        if asked:
            raise UserError(f"{name} is of a protocol, and --coast a motion of its own; leave one of them out")


def refuse_without_coast(given: Collection[str]) -> None:
    """Figures of a coast where there is none. Raises UserError."""
    for name in given:
        raise UserError(f"{OPTIONS[name]} is of a coast; add --coast, or leave it out")
