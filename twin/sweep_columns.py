"""The columns of a sweep: their names with units, which are required, and which values a bench can have meant."""

from __future__ import annotations

from collections.abc import Collection

COLUMNS = (
    "time_s",
    "reference_deg",
    "measured_deg",
    "direction",
    "speed_rpm",
    "turn",
    "temperature_c",
    "air_gap_mm",
    "mounting_deg",
    "vx",
    "vy",
    "current_a",
    "magnitude",
    "agc",
    "status",
    "frame",
)
"""Every column that the project knows, in the order of the file format."""
REQUIRED = ("reference_deg", "measured_deg")


def is_spin(names: Collection[str]) -> bool:
    """Whether columns are those of a log without a reference: the sensor's readings over time, or its channels."""
    channels = "vx" in names and "vy" in names
    return "reference_deg" not in names and (channels or ("measured_deg" in names and "time_s" in names))


def lacking(names: Collection[str], *, spin: bool = False) -> str | None:
    """Which column is missing from a recording, as a message says it; None where none is.

    ``spin``: a log without a reference will do, see :func:`is_spin`.
    """
    if spin and is_spin(names):
        return None
    if spin and "measured_deg" in names and "reference_deg" not in names:
        return (
            "column time_s is missing, as without reference_deg the time tells the motion (of 1000 even readings a "
            'second --columns "time_s=index/1000,measured_deg=measured_deg" makes it)'
        )
    if is_spin(names):
        return "column reference_deg is missing, needed here: explain, compensate and export take a log without it"
    return next((f"column {needed} is missing" for needed in REQUIRED if needed not in names), None)


OF_SETUP = ("air_gap_mm", "mounting_deg")
"""Columns that hold one number for a whole recording: how the bench was set up for it."""
TOLD_BY_SENSOR = ("magnitude", "agc", "status", "frame")
"""What a sensor or its link says of itself: no cause follows them, the check of the set-up reads them."""
MAY_BE_MISSING = frozenset({"temperature_c", "current_a", *OF_SETUP, *TOLD_BY_SENSOR})
"""Columns whose single cells may be empty: the row is used all the same."""
PLAUSIBLE = {
    "time_s": (-1e12, 1e12),
    "reference_deg": (-1e9, 1e9),
    "measured_deg": (-1e9, 1e9),
    "speed_rpm": (-1e7, 1e7),
    "turn": (-1e9, 1e9),
    "temperature_c": (-273.15, 1e4),
    "air_gap_mm": (1e-3, 200.0),
    "mounting_deg": (-1e9, 1e9),
    "vx": (-1e12, 1e12),
    "vy": (-1e12, 1e12),
    "current_a": (-1e5, 1e5),
    "magnitude": (-1e18, 1e18),
    "agc": (-1e18, 1e18),
    "status": (-1e18, 1e18),
    "frame": (-1e18, 1e18),
}
"""Lowest and highest value of a column, in its unit; beyond them a cell is a mistake."""
SMALLEST_AMPLITUDE = 1e-12
"""Largest value of a channel below which it holds no signal in any unit, and squares leave the range of numbers."""
