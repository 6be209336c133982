"""Logs drawn at random: names, units, dialects, motions and further columns, by code that does not know the reader."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.untidy.generator import Array, counts, table

REFERENCES = (
    *("ref", "Reference", "enc", "encoder", "Encoder Angle", "stepper", "stage", "target", "true_angle", "motor_pos"),
    *("shaft", "Soll", "commanded", "ref_pos"),
)
SENSORS = (
    *("angle", "sensor", "AS5600", "hall", "measured", "Sensor Angle", "mag", "output", "meas", "position", "Ist"),
    *("TLE5012B", "theta", "reading"),
)
A_TURN = (2400, 3600, 4096, 8192, 12_800, 16_384, 40_000)
DIALECTS = ((",", "."), (";", ","), ("\t", "."), (";", "."), ("\t", ","))


@dataclass(frozen=True)
class Mixed:
    """A log, the angles that it holds, and to what resolution it holds them."""

    text: str
    reference_deg: Array
    measured_deg: Array
    resolution_deg: tuple[float, float]
    up_to_a_zero: bool = False

    def held(self, reference_deg: Array, measured_deg: Array) -> bool:
        """Whether these are the angles of the log."""
        pairs = ((reference_deg, self.reference_deg), (measured_deg, self.measured_deg))
        off = [(found - true + 180.0) % 360.0 - 180.0 for found, true in pairs]
        if self.up_to_a_zero:
            off = [(one - one[0] + 180.0) % 360.0 - 180.0 for one in off]
        parts = 2.0 if self.up_to_a_zero else 1.0
        return all(bool(np.max(np.abs(one)) <= parts * to) for one, to in zip(off, self.resolution_deg, strict=True))


def drawn(seed: int) -> Mixed:
    """The log of a seed: 0.6 to 5 turns, there or there and back, with errors of orders 1 and 2 and noise."""
    rng = np.random.default_rng(seed)
    turns, rows = float(rng.choice([0.6, 1.0, 2.0, 5.0])), int(rng.choice([100, 360, 720]))
    shaft = np.linspace(0.0, 360.0 * turns, rows, endpoint=False) + rng.uniform(0.0, 360.0)
    shaft = np.concatenate([shaft, shaft[::-1]]) if rng.random() < 0.3 else shaft
    first, second = np.sin(np.radians(shaft + rng.uniform(0.0, 360.0))), np.sin(np.radians(2.0 * shaft))
    error = rng.uniform(0.1, 2.0) * first + 0.3 * second + 0.03 * rng.standard_normal(shaft.size)
    measured = rng.choice([-1.0, 1.0]) * shaft + rng.uniform(0.0, 360.0) + error
    reference_name, reference, to = _told(rng, shaft, str(rng.choice(REFERENCES)), wrapped=rng.random() < 0.5)
    sensor_name, sensor, sensor_to = _told(rng, measured, str(rng.choice(SENSORS)), wrapped=rng.random() < 0.7)
    pair = [(reference_name, reference), (sensor_name, sensor)]
    columns = dict([*_further(rng, shaft), *(pair if rng.random() < 0.5 else pair[::-1])])
    separator, decimal = DIALECTS[rng.integers(0, len(DIALECTS))]
    return Mixed(table(columns, sep=separator, decimal=decimal), shaft, measured, (to, sensor_to))


def _told(
    rng: np.random.Generator, angle_deg: Array, name: str, *, wrapped: bool, counts_wrapped: bool = False
) -> tuple[str, Array, float]:
    """A name, the angle in the unit that it tells or does not tell, and the resolution [deg]."""
    values = angle_deg % 360.0 if wrapped else angle_deg
    fine = 1e-3
    ways = (
        (f"{name}_deg", values, fine),
        (f"{name} [deg]", values, fine),
        (name, values, fine),
        (f"{name} (rad)", np.radians(values), fine),
        (f"{name}_rad", np.radians(values), fine),
        (name, np.radians(values), fine),
        (f"{name} [rev]", values / 360.0, fine),
    )
    k = int(rng.integers(0, len(ways) + 1))
    if k < len(ways):
        return ways[k]
    a_turn = int(rng.choice(A_TURN))
    called = str(rng.choice([f"{name}_counts", f"{name} raw", name]))
    return called, counts(angle_deg, a_turn, wrapped=wrapped or counts_wrapped), 180.0 / a_turn + fine


def _further(rng: np.random.Generator, shaft: Array) -> list[tuple[str, Array]]:
    """Columns that are no angle."""
    rows = np.arange(shaft.size, dtype=np.float64)
    return (
        [("time_ms", 10.0 * rows)],
        [("t", 0.01 * rows)],
        [("n", rows)],
        [("error", rng.standard_normal(shaft.size)), ("agc", np.round(128.0 + 5.0 * np.sin(shaft)))],
        [("x", rows)],
        [],
    )[rng.integers(0, 6)]


def drawn_geared(seed: int) -> Mixed:
    """The log of a seed in which one of both angles turns 2 to 20 times in a turn of the shaft; up to a zero.

    It is sampled at least three times a turn of the faster one. Counts are wrapped: of others it is not told whether a
    turn of the shaft has so many, or a turn of what is geared to it.
    """
    rng = np.random.default_rng(seed)
    times, turns = int(rng.choice([2, 3, 4, 5, 7, 11, 14, 20])), float(rng.choice([1.0, 1.5, 3.0]))
    rows = int(max(rng.choice([180, 360, 720]), 3 * times * turns))
    shaft = np.linspace(0.0, 360.0 * turns, rows, endpoint=False) + rng.uniform(0.0, 360.0)
    shaft = np.concatenate([shaft, shaft[::-1]]) if rng.random() < 0.3 else shaft
    errors = (rng.uniform(0.1, 1.5), rng.uniform(0.0, 0.3), 0.02)
    waves = (np.sin(np.radians(shaft + 10.0)), np.sin(np.radians(times * shaft)), rng.standard_normal(shaft.size))
    measured = rng.choice([-1.0, 1.0]) * shaft + sum(size * wave for size, wave in zip(errors, waves, strict=True))
    faster = (1, times) if rng.random() < 0.7 else (times, 1)
    names = str(rng.choice(REFERENCES[:6])), str(rng.choice(SENSORS[:6]))
    (ref, reference, to), (sensor, read, sensor_to) = (
        _told(rng, one * angle, name, wrapped=rng.random() < 0.6, counts_wrapped=True)
        for name, one, angle in zip(names, faster, (shaft, measured), strict=True)
    )
    return Mixed(table({ref: reference, sensor: read}), shaft, measured, (to, sensor_to), up_to_a_zero=True)
