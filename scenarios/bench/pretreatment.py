"""Pretreatment, as in the paper: manifest errors are rejected before anything is computed from the readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scenarios.bench.readings import Reading
from twin.angles import Array, radians, wrap_deg
from twin.sweep_file import csv_text

MANIFEST_DEG = 20.0
"""Farther off the typical error than any encoder that works: a wrong reading, not a large error."""


@dataclass(frozen=True)
class Pretreated:
    """Readings that are used, and the places in the plan of those that are not, with the reason."""

    kept: tuple[Reading, ...]
    rejected: dict[int, str]


def pretreat(readings: Sequence[Reading], *, manifest_deg: float = MANIFEST_DEG) -> Pretreated:
    """Reject readings without an index, repeated ones, and those farther off than ``manifest_deg``."""
    rejected: dict[int, str] = {}
    seen: set[int] = set()
    usable = []
    for reading in readings:
        if reading.index in seen:
            continue
        seen.add(reading.index)
        if reading.index_seen:
            usable.append(reading)
        else:
            rejected[reading.index] = "the reference had not passed its index"
    if usable:
        off = np.abs(errors_deg(usable))
        for reading, distance in zip(usable, off, strict=True):
            if distance > manifest_deg:
                rejected[reading.index] = f"{distance:.1f} deg off the typical error"
    return Pretreated(tuple(one for one in usable if one.index not in rejected), dict(sorted(rejected.items())))


def errors_deg(readings: Sequence[Reading]) -> Array:
    """Angle errors [deg] (n,), in the better counting sense, the typical one taken off; shaft's sense."""
    measured = np.array([one.measured_deg for one in readings])
    reference = np.array([one.reference_deg for one in readings])
    best = None
    for slope in (1.0, -1.0):
        difference = slope * measured - reference
        centre = np.degrees(np.angle(np.mean(np.exp(1j * radians(difference)))))
        off = wrap_deg(difference - centre)
        off = wrap_deg(off - np.median(off))
        if best is None or np.median(np.abs(off)) < np.median(np.abs(best)):
            best = off
    assert best is not None
    return best


def sweep_text(readings: Sequence[Reading]) -> str:
    """The text of a sweep file of readings: the columns that every reading has."""
    columns: dict[str, Sequence[float | None]] = {
        "time_s": [one.time_s for one in readings],
        "reference_deg": [one.reference_deg for one in readings],
        "measured_deg": [one.measured_deg for one in readings],
        "direction": [one.direction for one in readings],
        "speed_rpm": [one.speed_rpm for one in readings],
        "turn": [one.turn for one in readings],
        "temperature_c": [one.temperature_c for one in readings],
        "vx": [one.vx for one in readings],
        "vy": [one.vy for one in readings],
    }
    recorded = {name: values for name, values in columns.items() if None not in values}
    arrays = {name: np.array(values, dtype=np.float64) for name, values in recorded.items()}
    if not np.any(arrays["speed_rpm"]):
        del arrays["speed_rpm"]
    return csv_text(arrays)
