"""Units that logs are written in, and what turns them into those of a sweep's columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import Array


@dataclass(frozen=True)
class Unit:
    """A unit: what it measures, and the factor and addend that turn it into the unit of a sweep's column."""

    name: str
    quantity: str
    factor: float = 1.0
    addend: float = 0.0

    def converted(self, values: Array) -> Array:
        """Values (n,) in this unit as the sweep's column counts them."""
        return values * self.factor + self.addend


_DEG = 180.0 / np.pi
_LISTED: tuple[tuple[Unit, str], ...] = (
    (Unit("deg", "angle"), "degree degrees degs ° º"),
    (Unit("rad", "angle", _DEG), "radian radians rads"),
    (Unit("mrad", "angle", _DEG / 1000.0), "millirad milliradian milliradians"),
    (Unit("rev", "angle", 360.0), "revs revolution revolutions turn turns rotation rotations umdrehungen"),
    (Unit("gon", "angle", 0.9), "gons"),
    (Unit("arcmin", "angle", 1.0 / 60.0), "arcminute arcminutes"),
    (Unit("arcsec", "angle", 1.0 / 3600.0), "arcsecond arcseconds"),
    (Unit("mdeg", "angle", 1e-3), "millideg"),
    (Unit("cdeg", "angle", 0.01), "centideg centidegree centidegrees"),
    (Unit("s", "time"), "sec secs second seconds sekunden"),
    (Unit("ms", "time", 1e-3), "msec msecs millis millisec milliseconds"),
    (Unit("us", "time", 1e-6), "usec usecs micros microsec microseconds µs μs"),
    (Unit("ns", "time", 1e-9), "nsec nsecs nanos nanoseconds"),
    (Unit("min", "time", 60.0), "minute minutes"),
    (Unit("rpm", "speed"), "r/min rev/min 1/min u/min min-1"),
    (Unit("rad/s", "speed", 30.0 / np.pi), "rads/s rad/sec radps"),
    (Unit("deg/s", "speed", 1.0 / 6.0), "°/s deg/sec degps dps"),
    (Unit("rev/s", "speed", 60.0), "rps hz 1/s turns/s"),
    (Unit("C", "temperature"), "°c ºc degc celsius"),
    (Unit("K", "temperature", 1.0, -273.15), "kelvin"),
    (Unit("F", "temperature", 5.0 / 9.0, -32.0 * 5.0 / 9.0), "°f ºf degf fahrenheit"),
    (Unit("A", "current"), "amp amps ampere amperes"),
    (Unit("mA", "current", 1e-3), "milliamp milliamps milliampere milliamperes"),
    (Unit("mm", "length"), "millimetre millimeter"),
    (Unit("um", "length", 1e-3), "µm μm micron microns"),
)
UNITS = {unit.name: unit for unit, _ in _LISTED}
"""Each unit by the name under which ``--columns`` takes it."""
_BY_ALIAS = {word: unit for unit, words in _LISTED for word in (unit.name.lower(), *words.split())}
COUNTS = frozenset({"counts", "count", "cnt", "cnts", "ticks", "tick", "lsb", "lsbs", "raw", "pulses", "steps", "inc"})
"""Words for a count of steps, whose size no unit tells: how many make a turn must be found."""
QUANTITY = {
    "time_s": "time",
    "reference_deg": "angle",
    "measured_deg": "angle",
    "mounting_deg": "angle",
    "speed_rpm": "speed",
    "temperature_c": "temperature",
    "air_gap_mm": "length",
    "current_a": "current",
}
"""What a sweep's column measures; those that are missing here have no unit, or any."""


def unit_of(word: str) -> Unit | None:
    """The unit that a word of a header stands for; None for one that is none."""
    return _BY_ALIAS.get(word.strip().lower())
