"""A rotor under the torques that act on it: friction of three kinds, cogging, unbalance, a belt, mains, load steps.

Torques are given as the angular accelerations that they would give the rotor alone: rad/s^2 a unit of its inertia.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Drive = Callable[[float, float, float], float]
"""Acceleration by the drive at a time [s], an angle [rad] and a speed [rad/s]."""
STEPS_A_PERIOD = 20.0
"""Of integration, in a period of the fastest torque: what the fourth order leaves out of it is below 1e-4 of it."""
AT_REST = 0.2
"""Below this speed [rad/s] dry friction fades, so that a shaft at rest is not thrown to and fro."""


@dataclass(frozen=True)
class Wave:
    """A torque locked to the angle: ``size`` sin(``order`` angle + ``phase``)."""

    order: int
    size: float
    phase: float


@dataclass(frozen=True)
class Hum:
    """A torque locked to the time: ``size`` sin(2 pi ``frequency_Hz`` t + ``phase``)."""

    frequency_Hz: float
    size: float
    phase: float


@dataclass(frozen=True)
class Belt:
    """A second inertia behind a spring: its share of the rotor's, the resonance against a held rotor, its damping."""

    frequency_Hz: float
    damping: float
    inertia: float


@dataclass(frozen=True)
class Step:
    """A load that comes on at a time and stays."""

    time_s: float
    size: float


@dataclass(frozen=True)
class Rotor:
    """What acts on the shaft besides its drive."""

    coulomb: float = 0.0
    viscous: float = 0.0
    """1/s."""
    quadratic: float = 0.0
    """1/rad."""
    drag_ripple: float = 0.0
    """Share of the dry friction that comes and goes once a turn: a seal, a brush, a belt that rubs."""
    viscous_ripple: float = 0.0
    """The same of the viscous friction; no air drag does so: its response would not fall with the speed at all."""
    drag_phase: float = 0.0
    waves: tuple[Wave, ...] = ()
    """Cogging, and gravity on an unbalance."""
    hums: tuple[Hum, ...] = ()
    belt: Belt | None = None
    steps: tuple[Step, ...] = ()

    def friction(self, speed: float) -> float:
        """Deceleration against the motion, without its ripple."""
        size = abs(speed)
        dry = self.coulomb * math.tanh(size / AT_REST)
        return math.copysign(dry + self.viscous * size + self.quadratic * size * size, speed)

    def friction_ripple(self, speed: float) -> float:
        """Amplitude of what of the friction comes and goes once a turn, signed as it."""
        size = abs(speed)
        dry = self.drag_ripple * self.coulomb * math.tanh(size / AT_REST)
        return math.copysign(dry + self.viscous_ripple * self.viscous * size, speed)

    def fastest_order(self) -> float:
        """Cycles a turn of the finest torque."""
        return max([4.0, *(float(wave.order) for wave in self.waves)])

    def fastest_Hz(self) -> float:
        """Of what is locked to the time, and of the belt."""
        belt = self.belt.frequency_Hz * math.sqrt(1.0 + self.belt.inertia) if self.belt else 0.0
        return max([10.0, 1.2 * belt, *(hum.frequency_Hz for hum in self.hums)])

    def response_deg(self, order: int, speed: float) -> float:
        """Amplitude that the torques locked to the angle give it at a constant speed [rad/s], for a rotor alone."""
        total = sum(
            (
                wave.size * complex(math.cos(wave.phase), math.sin(wave.phase))
                for wave in self.waves
                if wave.order == order
            ),
            0j,
        )
        if order == 1:
            drag = self.friction_ripple(abs(speed))
            total -= drag * complex(math.cos(self.drag_phase), math.sin(self.drag_phase)) * 1j
        return math.degrees(abs(total) / (order * speed) ** 2)


@dataclass(frozen=True)
class Trajectory:
    """Where the shaft was: times [s], angles [rad], speeds [rad/s] and those behind the belt, shape (n,) each."""

    time_s: Array
    angle: Array
    speed: Array
    behind_angle: Array
    behind_speed: Array

    def at(self, time_s: Array) -> tuple[Array, Array]:
        """Angle [rad] and speed [rad/s] between the steps, by the cubic through angles and speeds at both ends."""
        left = np.clip(np.searchsorted(self.time_s, time_s, side="right") - 1, 0, self.time_s.size - 2)
        length = self.time_s[left + 1] - self.time_s[left]
        u = (time_s - self.time_s[left]) / length
        first, last = self.angle[left], self.angle[left + 1]
        into, out = self.speed[left] * length, self.speed[left + 1] * length
        rise = last - first
        second, third = 3.0 * rise - 2.0 * into - out, into + out - 2.0 * rise
        angle = first + u * (into + u * (second + u * third))
        return angle, (into + u * (2.0 * second + 3.0 * u * third)) / length


def acceleration(
    rotor: Rotor, drive: Drive | None
) -> Callable[[float, float, float, float, float], tuple[float, float]]:
    """Of rotor and second inertia, at a time, angle, speed, and angle and speed behind the belt."""
    waves = [(float(wave.order), wave.size, wave.phase) for wave in rotor.waves]
    hums = [(2.0 * math.pi * hum.frequency_Hz, hum.size, hum.phase) for hum in rotor.hums]
    belt = rotor.belt
    stiffness = (2.0 * math.pi * belt.frequency_Hz) ** 2 if belt else 0.0
    damping = 4.0 * math.pi * belt.frequency_Hz * belt.damping if belt else 0.0

    def found(time: float, angle: float, speed: float, far: float, far_speed: float) -> tuple[float, float]:
        total = -rotor.friction(speed) - rotor.friction_ripple(speed) * math.cos(angle + rotor.drag_phase)
        for order, size, phase in waves:
            total += size * math.sin(order * angle + phase)
        for turn, size, phase in hums:
            total += size * math.sin(turn * time + phase)
        for step in rotor.steps:
            if time >= step.time_s:
                total += step.size
        if drive is not None:
            total += drive(time, angle, speed)
        if belt is None:
            return total, 0.0
        # of the second inertia, whose share of the rotor's is what the rotor feels of it
        pull = stiffness * (angle - far) + damping * (speed - far_speed)
        return total - belt.inertia * pull, pull

    return found


def integrate(
    rotor: Rotor, drive: Drive | None, *, speed: float, duration_s: float, angle: float = 0.0, stop: float = 0.0
) -> Trajectory:
    """The motion from a start speed [rad/s] on, until it has slowed below ``stop`` or the time is over.

    Classical Runge-Kutta steps of the fourth order, shorter the faster the shaft turns.
    """
    slope = acceleration(rotor, drive)
    time, far, far_speed = 0.0, angle, speed
    rows = [(time, angle, speed, far, far_speed)]
    order, longest = rotor.fastest_order(), 1.0 / (STEPS_A_PERIOD * rotor.fastest_Hz())
    while time < duration_s and abs(speed) >= stop:
        h = min(longest, 2.0 * math.pi / (STEPS_A_PERIOD * order * max(abs(speed), 1e-3)))
        half = 0.5 * h
        a1, b1 = slope(time, angle, speed, far, far_speed)
        v2, w2 = speed + half * a1, far_speed + half * b1
        a2, b2 = slope(time + half, angle + half * speed, v2, far + half * far_speed, w2)
        v3, w3 = speed + half * a2, far_speed + half * b2
        a3, b3 = slope(time + half, angle + half * v2, v3, far + half * w2, w3)
        v4, w4 = speed + h * a3, far_speed + h * b3
        a4, b4 = slope(time + h, angle + h * v3, v4, far + h * w3, w4)
        angle += h / 6.0 * (speed + 2.0 * (v2 + v3) + v4)
        far += h / 6.0 * (far_speed + 2.0 * (w2 + w3) + w4)
        speed += h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)
        far_speed += h / 6.0 * (b1 + 2.0 * (b2 + b3) + b4)
        time += h
        rows.append((time, angle, speed, far, far_speed))
    columns = np.array(rows).T
    return Trajectory(*columns)
