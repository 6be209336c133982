"""Motions with acceleration: a shaft that swings to and fro, one that is run up and down."""

from __future__ import annotations

import numpy as np

from ..motion import Array, Motion, on_the_move


def _motion(protocol: str, time_s: Array, shaft_deg: Array, speed_deg_s: Array, points: int) -> Motion:
    forward = (speed_deg_s >= 0.0).astype(np.int64)
    return on_the_move(
        protocol,
        time_s=time_s,
        shaft_deg=shaft_deg,
        speed_deg_s=speed_deg_s,
        points=points,
        turn=np.cumsum(np.diff(forward, prepend=forward[0]) != 0),
    )


def swing(rng: np.random.Generator) -> Motion:
    """Harmonic swings over two turns: the acceleration is largest where the shaft turns back."""
    rows, periods = int(rng.choice((450, 600, 900))), float(rng.choice((1.0, 2.0)))
    half, speed = float(rng.uniform(270.0, 540.0)), float(rng.uniform(600.0, 1800.0))
    omega = speed / half
    time = np.arange(rows) * periods * 2 * np.pi / omega / rows
    start = float(rng.uniform(0.0, 360.0))
    return _motion("swing", 5.0 + time, start - half * np.cos(omega * time), speed * np.sin(omega * time), rows // 4)


def run_up(rng: np.random.Generator) -> Motion:
    """A smooth run-up and a run-down, over and over: speed as a raised cosine."""
    rows, bursts = int(rng.choice((600, 900))), int(rng.choice((3, 4)))
    low, high = float(rng.uniform(150.0, 400.0)), float(rng.uniform(1200.0, 2400.0))
    mean, swing_deg_s = 0.5 * (low + high), 0.5 * (high - low)
    # about two and a quarter turns each time, so that acceleration and angle do not go together
    omega = 2 * np.pi * mean / 810.0
    time = np.arange(rows) * bursts * 2 * np.pi / omega / rows
    shaft = float(rng.uniform(0.0, 360.0)) + mean * time - swing_deg_s / omega * np.sin(omega * time)
    return _motion("run_up", 5.0 + time, shaft, mean - swing_deg_s * np.cos(omega * time), rows // (3 * bursts))
