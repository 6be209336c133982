"""What turns a rotor: a motor on a constant voltage, one that is told several speeds, a hand, a stepped field."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass


@dataclass(frozen=True)
class Speeds:
    """A motor that draws the shaft towards a speed as its voltage tells it, one speed after the other."""

    starts_s: tuple[float, ...]
    targets: tuple[float, ...]
    """rad/s; by straight ramps of ``ramp_s`` from one to the next."""
    gain: float
    """1/s: its back-EMF over its inertia."""
    feed: float
    """rad/s^2: what it gives besides, against the friction at the first speed."""
    ramp_s: float = 0.3

    def __call__(self, time_s: float, angle: float, speed: float) -> float:
        """Acceleration by the motor."""
        at = max(bisect_right(self.starts_s, time_s) - 1, 0)
        target = self.targets[at]
        if at:
            share = min((time_s - self.starts_s[at]) / self.ramp_s, 1.0)
            target = self.targets[at - 1] + share * (target - self.targets[at - 1])
        return self.gain * (target - speed) + math.copysign(self.feed, target)


@dataclass(frozen=True)
class Rocking:
    """A hand that rocks the shaft about an angle: a spring to where the hand is."""

    middle: float
    swing: float
    """rad."""
    frequency_Hz: float
    stiffness: float
    """1/s^2."""
    damping: float
    """1/s."""

    def __call__(self, time_s: float, angle: float, speed: float) -> float:
        """Acceleration by the hand."""
        turn = 2.0 * math.pi * self.frequency_Hz
        wanted = self.middle + self.swing * math.sin(turn * time_s)
        return self.stiffness * (wanted - angle) + self.damping * (turn * self.swing * math.cos(turn * time_s) - speed)


@dataclass(frozen=True)
class Stepping:
    """A field that is turned in micro-steps and pulls the rotor's poles after it."""

    poles: int
    """Pole pairs."""
    holding: float
    """rad/s^2."""
    damping: float
    """1/s."""
    rate: float
    """rad/s of the shaft, signed."""
    steps_a_turn: int

    def command(self, time_s: float) -> float:
        """Where the drive has turned the field to, rad of the shaft."""
        step = 2.0 * math.pi / self.steps_a_turn
        return math.floor(self.rate * time_s / step) * step

    def __call__(self, time_s: float, angle: float, speed: float) -> float:
        """Acceleration by the field."""
        return self.holding * math.sin(self.poles * (self.command(time_s) - angle)) - self.damping * speed
