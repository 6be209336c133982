"""What lies between the reference's shaft and the magnet's: joints, gears, twist, play, bearings."""

from __future__ import annotations

import numpy as np

from ..baseline import Setting
from ..motion import Array, Motion
from .device import Mechanism
from .kind import Planned


def acceleration(motion: Motion) -> Array:
    """Angular acceleration of each reading, deg/s^2, from the speed over time; zero across a standing shaft."""
    if not motion.moving:
        return np.zeros_like(motion.time_s)
    return np.gradient(motion.speed_deg_s, motion.time_s)


def torsion_inertia(rng: np.random.Generator, setting: Setting) -> Planned:
    """A disk on a soft shaft: the magnet's end stays behind by J / c times its acceleration."""
    size = float(rng.uniform(0.15, 0.4))
    compliance = size / float(np.max(np.abs(acceleration(setting.motion))))
    return Planned(Mechanism(shaft=lambda shaft, motion: shaft - compliance * acceleration(motion)), size)


def drag_torsion(rng: np.random.Generator, setting: Setting) -> Planned:
    """Air and bearing drag twist the shaft, with the square of the speed."""
    size = float(rng.uniform(0.15, 0.4))
    fastest = float(np.max(np.abs(setting.motion.speed_rpm)))

    def shaft(at: Array, motion: Motion) -> Array:
        return at - size * motion.speed_rpm * np.abs(motion.speed_rpm) / fastest**2

    return Planned(Mechanism(shaft=shaft), size)


def universal_joint(rng: np.random.Generator, setting: Setting) -> Planned:
    """A joint bent by an angle: tan(out) = cos(bend) tan(in), exactly."""
    bend, phase = float(rng.uniform(4.0, 7.0)), float(rng.uniform(0.0, 360.0))

    def shaft(at: Array, motion: Motion) -> Array:
        angle = np.radians(at - phase)
        lead = np.arctan2(np.cos(np.radians(bend)) * np.sin(angle), np.cos(angle)) - angle
        return at + np.degrees(np.angle(np.exp(1j * lead)))

    amplitude = float(np.degrees(np.tan(np.radians(bend) / 2) ** 2))
    return Planned(Mechanism(shaft=shaft), amplitude, {"cardan_coupling": {"amplitude_deg": amplitude}})


def play_under_friction(rng: np.random.Generator, setting: Setting) -> Planned:
    """A coupling with play that friction holds back: the magnet follows a half width behind, either way."""
    half = float(rng.uniform(0.06, 0.2))

    def shaft(at: Array, motion: Motion) -> Array:
        out, state = np.empty_like(at), at[0] - half * motion.direction[0]
        for row, here in enumerate(at):
            state = min(max(state, here - half), here + half)
            out[row] = state
        return out

    return Planned(Mechanism(shaft=shaft), half, {"backlash": {"half_width_deg": half}})


def play_under_weight(rng: np.random.Generator, setting: Setting) -> Planned:
    """A coupling with play and an unbalanced rotor: its weight lies on one flank for half a turn, then on the other."""
    half, heavy = float(rng.uniform(0.06, 0.2)), float(rng.uniform(0.0, 360.0))
    soft = np.radians(rng.uniform(2.0, 6.0))

    def shaft(at: Array, motion: Motion) -> Array:
        return at + half * np.tanh(np.sin(np.radians(at - heavy)) / soft)

    return Planned(Mechanism(shaft=shaft), half)


def gear_runout(rng: np.random.Generator, setting: Setting) -> Planned:
    """A gear of another number of teeth drives the sensor's: its runout comes round with its own turn, its mesh too."""
    ratio = float(rng.choice((17 / 23, 19 / 31, 29 / 23, 37 / 29)))
    size, phase = float(rng.uniform(0.08, 0.2)), float(rng.uniform(0.0, 360.0))

    def shaft(at: Array, motion: Motion) -> Array:
        return at + size * np.sin(np.radians(ratio * at + phase))

    return Planned(Mechanism(shaft=shaft), size)


def gear_mesh(rng: np.random.Generator, setting: Setting) -> Planned:
    """A pinion of 9 to 19 teeth: one bump of transmission error a tooth, fuller than a sine."""
    teeth = int(rng.integers(9, 20))
    size, phase = float(rng.uniform(0.08, 0.2)), float(rng.uniform(0.0, 360.0))

    def shaft(at: Array, motion: Motion) -> Array:
        wave = np.sin(np.radians(teeth * at + phase))
        return at + size * wave / np.sqrt(1.0 + 0.2 * wave)

    return Planned(Mechanism(shaft=shaft), size)


def belt(rng: np.random.Generator, setting: Setting) -> Planned:
    """A joint in a belt: a bump each time it runs over the pulley, once in so many turns."""
    turns, size = float(rng.uniform(1.35, 1.45)), float(rng.uniform(0.15, 0.35))
    width, first = float(rng.uniform(20.0, 50.0)) / 360.0, float(rng.uniform(0.0, 1.0))

    def shaft(at: Array, motion: Motion) -> Array:
        place = np.mod(at / 360.0 / turns - first + 0.5, 1.0) - 0.5
        return at + size * np.exp(-0.5 * (place * turns / width) ** 2)

    return Planned(Mechanism(shaft=shaft), size)


def microsteps(rng: np.random.Generator, setting: Setting) -> Planned:
    """A 200-step motor in microsteps: wrong phase currents once, twice, four times each electrical turn, 50 a turn."""
    size = float(rng.uniform(0.08, 0.2))
    shares, phases = np.array([1.0, rng.uniform(0.1, 0.3), rng.uniform(0.1, 0.3)]), rng.uniform(0.0, 2 * np.pi, 3)

    def shaft(at: Array, motion: Motion) -> Array:
        electrical = 50.0 * np.radians(at)
        waves = (share * np.sin(n * electrical + p) for n, share, p in zip((1, 2, 4), shares, phases, strict=True))
        return at + size * sum(waves)

    return Planned(Mechanism(shaft=shaft), size, {"drive_ripple": {"order": 50.0}})


def ball_bearing(rng: np.random.Generator, setting: Setting) -> Planned:
    """The cage carries a bad ball round: its order follows from ball and pitch diameter and contact angle."""
    ball, pitch, contact = rng.uniform(0.2, 0.32), 1.0, np.radians(rng.uniform(0.0, 25.0))
    order = float(0.5 * (1.0 - ball / pitch * np.cos(contact)))
    size, phase = float(rng.uniform(0.08, 0.2)), float(rng.uniform(0.0, 360.0))

    def shaft(at: Array, motion: Motion) -> Array:
        return at + size * np.sin(np.radians(order * at + phase))

    return Planned(Mechanism(shaft=shaft), size, {"bearing_wobble": {"order": order, "amplitude_deg": size}})


def head_vibration(rng: np.random.Generator, setting: Setting) -> Planned:
    """A pump shakes the sensor's head, in its own time whatever the shaft does."""
    motion = setting.motion
    frequency = float(rng.uniform(7.0, 0.25 / float(np.max(np.diff(motion.time_s)))))
    size, phase = float(rng.uniform(0.08, 0.2)), float(rng.uniform(0.0, 2 * np.pi))

    def shaft(at: Array, moved: Motion) -> Array:
        return at + size * np.sin(2 * np.pi * frequency * moved.time_s + phase)

    return Planned(Mechanism(shaft=shaft), size)
