"""A motor turns the shaft and no current is recorded: its field goes with what drag asks of it."""

from __future__ import annotations

import numpy as np

from tests.reported_cases.bench import Case, case, some_sensor


def field_of_drag(rng: np.random.Generator) -> Case:
    """Several steady speeds, one way or both, and a drag in proportion to the speed."""
    ways = (1.0, -1.0) if rng.random() < 0.5 else (1.0,)
    speeds = np.sort(rng.uniform(100.0, 2000.0, 3))
    points = int(rng.choice([180, 256, 360]))
    rpm = np.repeat([way * speed for way in ways for speed in speeds], 2 * points)
    step = np.where(rpm > 0.0, 1.0, -1.0) * (360.0 / points)
    shaft, time = np.cumsum(step), np.cumsum(np.abs(step) / (6.0 * np.abs(rpm)))
    towards = rng.uniform(0.0, 2.0 * np.pi)
    share = np.radians(rng.uniform(0.06, 0.3)) * rpm / np.max(np.abs(rpm))
    sensor = some_sensor(rng, noise_deg=(0.01, 0.05))
    channels = sensor.channels(np.radians(shaft)) + np.multiply.outer([np.cos(towards), np.sin(towards)], share)
    return case(shaft, sensor.angle_deg(channels, rng), time_s=time, speed_rpm=rpm)
