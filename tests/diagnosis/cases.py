"""Simulated sweeps with known parameters, anywhere in the range that the diagnoser promises."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from hypothesis import strategies as st

from diagnosis.error_model.model import Readings
from twin.angles import Array
from twin.baseline import FACTORS

NOISE_RAD = float(np.radians(0.02))


def points() -> st.SearchStrategy[Array]:
    """Points (6,): offsets to 30 %, gain ratio 0.5 to 2, phase to 6 deg, q to 5 %, any zero."""
    offset = st.floats(-0.2, 0.2)
    return st.tuples(
        offset, offset, st.floats(-0.69, 0.69), st.floats(-0.1, 0.1), st.floats(-0.05, 0.05), st.floats(-3.1, 3.1)
    ).map(lambda p: np.array([p[0], p[1], np.exp(p[2]), p[3], p[4], p[5]]))


senses = st.sampled_from([(1, 1), (1, -1), (-1, 1), (-1, -1)])


def measured(point: Array, reference: Array, sensor: int = 1, output: int = 1, noise: Array | float = 0.0) -> Array:
    """Readings [rad] of a point (6,) at reference angles (n,) [rad]."""
    x, y = Readings.of(reference, reference, sensor_sense=float(sensor)).channels(point)
    return np.asarray(output * np.arctan2(y, x) + noise)


def turn(readings: int) -> Array:
    """Reference angles (n,) [rad] evenly round one turn, not at the axes."""
    return 0.1 + 2.0 * np.pi * np.arange(readings) / readings


def point_of(values: Mapping[str, Mapping[str, float]]) -> Array:
    """The point (6,) of a twin's parameters; effects that are absent are at null."""
    point = []
    for factor in FACTORS:
        own = float(values.get(factor.key, {}).get(factor.param, factor.null))
        point.append(float(np.radians(own)) if factor.unit == "deg" else factor.scale * own)
    return np.array(point)
