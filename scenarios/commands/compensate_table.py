"""A correction as a table of numbers for firmware: CSV, one row a reading, at one temperature or at several."""

from __future__ import annotations

import io

import numpy as np

from diagnosis.correction.compensation import Correction
from twin.angles import TAU, Array, wrap

_MOST_TEMPERATURES = 33


def table(correction: Correction, points: int, tolerance_deg: float) -> str:
    """CSV: reading, correction to add to slope x reading - zero, and the shaft angle.

    A correction that follows the temperature has a block of rows for each of so many temperatures that a straight line
    between two of them stays within the tolerance.
    """
    reading = TAU * np.arange(points) / points
    out = io.StringIO()
    follows = correction.drift is not None
    out.write(("temperature_c," if follows else "") + "reading_deg,correction_deg,shaft_deg\n")
    for temperature in temperatures_c(correction, tolerance_deg):
        first = [np.full(points, temperature)] if follows else []
        added = np.degrees(correction.correction(reading, temperature))
        shaft = np.degrees(correction.shaft(reading, temperature)) % 360.0
        for row in zip(*first, np.degrees(reading), added, shaft, strict=True):
            out.write(",".join(f"{value:.6f}" for value in row) + "\n")
    return out.getvalue()


def temperatures_c(correction: Correction, tolerance_deg: float) -> Array:
    """Temperatures [C], evenly spaced, between which straight lines follow the correction; 25 C without a drift."""
    drift = correction.drift
    if drift is None:
        return np.array([25.0])
    reading = TAU * np.arange(360) / 360
    for count in range(2, _MOST_TEMPERATURES + 1):
        knots = np.linspace(drift.low_c, drift.high_c, count)
        at = np.stack([correction.shaft(reading, c) for c in knots])
        middle = np.stack([correction.shaft(reading, c) for c in 0.5 * (knots[1:] + knots[:-1])])
        line = at[:-1] + 0.5 * wrap(at[1:] - at[:-1])
        if np.degrees(np.max(np.abs(wrap(middle - line)))) <= max(tolerance_deg, 1e-4):
            break
    return knots
