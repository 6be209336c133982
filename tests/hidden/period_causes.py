"""Causes with more than one period a turn: a sensor of several pole pairs, and the slots and poles of a motor."""

from __future__ import annotations

import numpy as np

from .baseline import Injected, Setting
from .motion import Array, Motion

MOTORS = ((6, 4), (6, 8), (9, 6), (9, 8), (9, 10), (12, 8), (12, 10), (12, 14), (12, 16), (18, 16), (18, 20), (24, 28))
"""Slots and poles of common motors with windings around single teeth."""


def plan_multipole(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: sqrt(2) times the RMS, shared by the lines at p and 2p; 3 to 12 periods, as the points allow."""
    periods = float(rng.integers(3, min(12, int(setting.motion.points_per_turn) // 6) + 1))
    around, share, twist = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.4, 0.9), rng.uniform(0.0, 2.0 * np.pi)
    size = periods * np.radians(strength)
    # Half of the phase turns the mean.
    size /= np.sqrt(1.0 + 2.0 * (1.0 - share**2) * np.sin(twist) ** 2)
    first, second = share * size, np.sqrt(1.0 - share**2) * size
    return Injected(
        "multipole",
        strength,
        {
            "periods": periods,
            "x_percent": 100.0 * first * float(np.cos(around)),
            "y_percent": 100.0 * first * float(np.sin(around)),
            "ratio": 1.0 + 2.0 * second * float(np.cos(twist)),
            "beta_deg": float(np.degrees(2.0 * second * np.sin(twist))),
        },
    )


def multipole(angle: Array, injected: Injected) -> Array:
    """The angle [rad] as the sensor tells it: one period's offset, gain ratio and phase, over the number of periods."""
    p = injected.parameters
    of_period = p["periods"] * angle
    x = np.cos(of_period) + 0.01 * p["x_percent"]
    y = p["ratio"] * (np.sin(of_period + np.radians(p["beta_deg"])) + 0.01 * p["y_percent"])
    away = np.angle((x + 1j * y) * np.exp(-1j * of_period))
    return angle + away / p["periods"]


def plan_motor_poles(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: sqrt(2) times the RMS of the lines at slots, poles and their doubles."""
    points = setting.motion.points_per_turn
    slots, poles = (float(one) for one in rng.choice([m for m in MOTORS if 4.3 * max(m) < points] or [MOTORS[0]]))
    sizes = np.array([1.0, 1.0, 0.5, 0.5]) * rng.uniform(0.8, 1.2, 4)
    return Injected(
        "motor_poles",
        strength,
        {"slots": slots, "poles": poles},
        {
            "orders": np.array([slots, poles, 2.0 * slots, 2.0 * poles]),
            "sizes_deg": strength * sizes / np.linalg.norm(sizes),
            "phases_deg": rng.uniform(-180.0, 180.0, 4),
        },
    )


def motor_poles(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """Each line over the angle of the rotor."""
    told = injected.hidden
    waves = np.sin(np.radians(told["orders"][:, None] * motion.shaft_deg + told["phases_deg"][:, None]))
    return np.asarray(shaft + told["sizes_deg"] @ waves)
