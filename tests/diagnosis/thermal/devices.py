"""A sensor of which two factors follow the temperature, and recordings of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scenarios.commands.protocol import Protocol
from twin.chain import Chain
from twin.motion import Motion
from twin.sweep import Sweep

X_PER_K = 0.004
"""Drift of offset x [%/K]."""
GAIN_PER_K = 0.006
"""Drift of the gain ratio [%/K]."""
FLOOR_DEG = 0.02
COLD_ROOM_HOT = (-40.0, 25.0, 85.0)


def steady(noise: dict[str, float] | None = None) -> Chain:
    """All factors there, none of which follows the temperature."""
    return (
        Chain()
        .with_effect("zero", zero_deg=37.0)
        .with_effect("offset", x_percent=0.75, y_percent=-0.7)
        .with_effect("gain_mismatch", ratio=1.01)
        .with_effect("phase", beta_deg=0.17)
        .with_effect("quadratic_nonlinearity", q_percent=0.2)
        .with_effect("noise", **(noise or {"rms_deg": FLOOR_DEG}))
    )


def warm(noise: dict[str, float] | None = None) -> Chain:
    """The same with two factors that follow it."""
    sensor = steady(noise).with_effect("offset_drift", x_percent_per_K=X_PER_K)
    return sensor.with_effect("gain_drift", percent_per_K=GAIN_PER_K)


def over(temperatures_c: tuple[float, ...], *, points: int = 90, turns: int = 2, both: bool = False) -> Motion:
    """Turns at each temperature, one after the other."""
    return Protocol(
        turns=turns, points=points, temperatures_c=temperatures_c, both_directions=both, channels=False
    ).motion()


def drifting(points: int = 90, turns: int = 8) -> Motion:
    """Turns during which the temperature rises steadily from 20 to 60 C."""
    motion = over((20.0,), points=points, turns=turns)
    return replace(motion, temperature_c=np.linspace(20.0, 60.0, len(motion)))


def each_at(sensors: dict[float, Chain], *, points: int = 180, seed: int = 0) -> list[Sweep]:
    """One sweep at each temperature, of the sensor as it is there."""
    return [
        chain.simulate(over((temperature,), points=points, turns=1), seed=seed + place)
        for place, (temperature, chain) in enumerate(sensors.items())
    ]
