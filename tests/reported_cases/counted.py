"""A reference of few counts: an encoder's own, or a log that was printed with few decimals."""

from __future__ import annotations

import numpy as np

from tests.reported_cases.bench import Array, Case, a_turn, case, some_sensor

COUNTS = (400, 800, 1440, 2000, 2048, 2400, 3600, 4000, 4096, 8192, 10_000, 14_400, 16_384, 20_000)
PRINTED = ((1.0, 0), (1.0, 1), (float(np.degrees(1.0)), 2), (float(np.degrees(1.0)), 3))
"""Degrees of a unit of angle, and with how many decimals it is printed."""


def coarse_reference(rng: np.random.Generator) -> Case:
    """Stops at even steps, one way or both, or a shaft that turns steadily but for a slow wow."""
    while True:
        shaft = _moved(rng)
        counts = int(rng.choice(COUNTS))
        read = np.round(shaft * (counts / 360.0)) * (360.0 / counts)
        # Where the stops are counts there is nothing to see.
        if float(np.std(read - shaft)) > 0.25 * 360.0 / counts:
            return _read(rng, shaft, read, counts)


def printed(rng: np.random.Generator) -> Case:
    """Both columns as a sketch prints them: whole degrees or tenths, hundredths of a radian or thousandths."""
    unit_deg, decimals = PRINTED[int(rng.integers(len(PRINTED)))]
    step = unit_deg * 10.0**-decimals
    while True:
        shaft = _moved(rng)
        off = _print(shaft, unit_deg, decimals) - np.mod(shaft, 360.0)
        # Where a value stays for several readings nothing but the sensor tells that the shaft goes on.
        if float(np.std(off)) > 0.25 * step and float(np.median(np.abs(np.diff(shaft)))) > step:
            break
    rounding = step / np.sqrt(12.0)
    measured = some_sensor(rng, noise_deg=(0.2 * rounding, 0.7 * rounding)).reading_deg(shaft, rng)
    read = {"reference_deg": shaft, "measured_deg": measured}
    columns = {name: _print(angle, unit_deg, decimals) for name, angle in read.items()}
    return Case(columns, {"step_deg": step}, decimals=9)


def _print(angle_deg: Array, unit_deg: float, decimals: int) -> Array:
    """An angle (n,) [deg] within a turn, as it is read back from a text of so many decimals of a unit."""
    return np.asarray(np.round(np.mod(angle_deg, 360.0) / unit_deg, decimals) * unit_deg)


def hand_turned(rng: np.random.Generator) -> Case:
    """Stops anywhere: where between two counts each of them was nobody knows."""
    shaft = np.cumsum(rng.uniform(0.3, 5.0, int(rng.choice([200, 400, 720]))))
    counts = int(rng.choice(COUNTS))
    return _read(rng, shaft, np.round(shaft * (counts / 360.0)) * (360.0 / counts), counts)


def _moved(rng: np.random.Generator) -> Array:
    """Angles of the shaft [deg], two turns or more."""
    if rng.random() < 0.6:
        there = a_turn(rng, points=int(rng.choice([90, 100, 120, 128, 180, 200, 256, 360, 500])), turns=2.0)
        return there if rng.random() < 0.5 else np.concatenate([there, there[::-1]])
    turns = np.linspace(0.0, rng.uniform(2.0, 5.0), int(rng.choice([500, 720, 1440, 2000])))
    wow = rng.uniform(0.0, 0.05) * np.sin(2.0 * np.pi * turns + rng.uniform(0.0, 6.0))
    return np.asarray(360.0 * turns + wow + rng.uniform(0.0, 360.0))


def _read(rng: np.random.Generator, shaft: Array, read: Array, counts: int) -> Case:
    rounding = 360.0 / counts / np.sqrt(12.0)
    sensor = some_sensor(rng, noise_deg=(0.2 * rounding, 0.7 * rounding))
    drawn = case(read, sensor.reading_deg(shaft, rng), truth={"counts_per_turn": counts})
    return Case(drawn.columns, drawn.truth, decimals=int(rng.choice([4, 5, 6])))
