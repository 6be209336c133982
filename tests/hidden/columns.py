"""Which columns of a sweep a bench writes down: all that it has, or fewer, as benches do."""

from __future__ import annotations

import numpy as np

from .chain import Bench, Readings
from .motion import Array, Demands, Motion


def all_columns(setup: Bench, readings: Readings) -> dict[str, Array]:
    """Every column that the motion has something to say in."""
    motion = setup.motion
    columns = {"time_s": motion.time_s, "reference_deg": readings.reference_deg, "measured_deg": readings.word_deg}
    columns |= {"direction": motion.named, "turn": motion.turn.astype(float)}
    if motion.moving:
        columns["speed_rpm"] = np.abs(motion.speed_rpm) * motion.named
    if np.ptp(motion.temperature_c) > 0:
        columns["temperature_c"] = motion.temperature_c
    return columns | ({"vx": readings.x, "vy": readings.y} if setup.channels else {})


def written_columns(
    setup: Bench, readings: Readings, demands: Demands, bench: str, rng: np.random.Generator
) -> dict[str, Array]:
    """The columns a bench of this kind writes down; redundant ones are left out at times."""
    motion = setup.motion
    hard = bench == "hard"
    omit = 0.5 if hard else 0.1
    columns: dict[str, Array] = {}
    if motion.moving or demands.time_column or not hard or rng.random() < 0.8:
        columns["time_s"] = motion.time_s
    wrapped = rng.random() < (0.6 if hard else 0.8)
    read = readings.reference_deg
    columns["reference_deg"] = np.mod(read, 360.0) if wrapped else read
    signed = hard and rng.random() < 0.3
    word = readings.word_deg
    columns["measured_deg"] = np.where(word >= 180.0, word - 360.0, word) if signed else word

    both = bool(np.ptp(motion.direction) > 0)
    several = len(np.unique(np.abs(motion.speed_rpm))) > 1
    if both and not rng.random() < omit:
        columns["direction"] = motion.named
    if motion.moving and not rng.random() < omit * (1.0 if several else 1.5):
        columns["speed_rpm"] = np.abs(motion.speed_rpm) * motion.named
    heated = bool(np.ptp(motion.temperature_c) > 0)
    if demands.turn_column or heated or rng.random() < (0.25 if hard else 0.3):
        columns["turn"] = motion.turn.astype(float)
    if hard:
        columns |= _warmth(motion, heated, rng)
    elif heated:
        columns["temperature_c"] = motion.temperature_c
    if setup.channels:
        columns["vx"], columns["vy"] = readings.x, readings.y
    return columns


def _warmth(motion: Motion, heated: bool, rng: np.random.Generator) -> dict[str, Array]:
    """The temperature as a poor bench records it: that of a chamber, with noise and gaps, or that of a warm room."""
    if heated:
        warm = motion.temperature_c.copy()
    elif rng.random() < 0.2:
        # a warm room: slow, small, and nothing to do with the readings
        share = np.linspace(0.0, 1.0, len(motion.time_s))
        warm = np.round(22.0 + 3.0 * rng.random() + rng.uniform(-1.5, 1.5) * share, 1)
    else:
        return {}
    if heated and rng.random() < 0.5:
        warm = np.round(warm + 0.15 * rng.standard_normal(len(warm)), 1)
    if rng.random() < 0.6:
        warm[rng.random(len(warm)) < rng.uniform(0.01, 0.1)] = np.nan
    return {"temperature_c": warm}
