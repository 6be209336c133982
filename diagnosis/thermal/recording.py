"""Readings of one sensor at several temperatures: one sweep that goes through them, or several sweeps together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from twin.angles import Array, IntArray, radians, wrap
from twin.errors import UserError
from twin.shown_name import shown_name
from twin.sweep import Sweep

SMALLEST_SPAN_K = 5.0
"""Readings whose temperatures differ by less were taken at one, as for a motion's "two temperatures"."""
_REMADE_RAD = np.radians(1.0)
"""Zeros farther apart than this were set anew: no mount of a magnet turns by so much with temperature."""


@dataclass(frozen=True, eq=False)
class Recording:
    """Readings (n,) of all sweeps, one sweep after the other.

    ``unit`` numbers the stretches whose reference may have found its zero anew: the sweeps, and in them the turns.
    """

    reference_rad: Array
    measured_rad: Array
    temperature_c: Array
    direction: Array
    unit: IntArray

    def __len__(self) -> int:
        return int(self.reference_rad.size)

    @classmethod
    def at_one_temperature(cls, reference_rad: Array, measured_rad: Array, temperature_c: float) -> Recording:
        """Readings (n,) that were all taken at one temperature [C], of which no more is known."""
        n = reference_rad.size
        return cls(reference_rad, measured_rad, np.full(n, temperature_c), np.ones(n), np.zeros(n, dtype=np.int64))

    def part(self, rows: Any) -> Recording:
        """Some of the readings: a mask (n,) or places."""
        return Recording(
            self.reference_rad[rows],
            self.measured_rad[rows],
            self.temperature_c[rows],
            self.direction[rows],
            self.unit[rows],
        )

    @property
    def span_K(self) -> float:
        """Highest less lowest temperature."""
        return float(np.ptp(self.temperature_c))

    @property
    def slope(self) -> int:
        """+1 where the readings count as the reference does, else -1; whatever the zero of each unit."""
        return _slope(self.reference_rad, self.measured_rad, self.unit)

    def unit_means(self, values: Array) -> Array:
        """Mean of values (n,) over each unit (units,); 0 where a unit has no reading."""
        count = np.bincount(self.unit)
        return np.bincount(self.unit, weights=values, minlength=count.size) / np.maximum(count, 1)

    def turned(self, by_rad: Array) -> Recording:
        """The reference of each unit turned by an angle (units,)."""
        return replace(self, reference_rad=self.reference_rad + by_rad[self.unit])

    def with_one_zero(self) -> Recording:
        """References that were set anew between units turned to the zero of the first; the same where none was."""
        offset = self.measured_rad - self.slope * self.reference_rad
        parts = [self.unit_means(wave) for wave in (np.cos(offset), np.sin(offset))]
        zero = np.arctan2(parts[1], parts[0])
        away = np.where(np.bincount(self.unit) > 0, wrap(zero - zero[self.unit[0]]), 0.0)
        return self.turned(self.slope * away) if np.max(np.abs(away)) > _REMADE_RAD else self


def joined(sweeps: Sequence[Sweep]) -> Recording:
    """The readings of sweeps of one sensor. Raises UserError where one of them counts the other way round."""
    parts, units = [], 0
    for sweep in sweeps:
        motion = sweep.motion()
        reference, measured = radians(sweep.reference_deg), radians(sweep.measured_deg)
        temperature = temperature_of(sweep)
        parts.append(Recording(reference, measured, temperature, motion.direction, units + motion.turn))
        units += int(motion.turn.max(initial=0)) + 1
        if parts[-1].slope != parts[0].slope:
            raise UserError(
                f"{shown_name(sweep.name)}: its angle counts the other way round than that of "
                f"{shown_name(sweeps[0].name)}; give sweeps of one sensor, all with the same settings"
            )
    columns = ("reference_rad", "measured_rad", "temperature_c", "direction", "unit")
    return Recording(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in columns})


def temperature_of(sweep: Sweep) -> Array:
    """Temperature (n,) [C] of each reading; a single one off both its neighbours, which agree, is taken from these.

    Only an odd reading of a thermometer looks like that: a temperature that comes back is one that the record takes
    turns with.
    """
    here = np.asarray(sweep.motion().temperature_c)
    # The neighbours of the first and the last are the two beside it.
    before, after = np.r_[here[2:3], here[:-1]], np.r_[here[1:], here[-3:-2]]
    odd = (
        (np.abs(after - before) < SMALLEST_SPAN_K)
        & (np.abs(here - before) > SMALLEST_SPAN_K)
        & (np.abs(here - after) > SMALLEST_SPAN_K)
    )
    level = np.round(here / SMALLEST_SPAN_K)
    levels, count = np.unique(level[odd], return_counts=True)
    lone = np.isin(level, levels[count == 1])
    return np.where(odd & lone, 0.5 * (before + after), here)


def counts_as(sweep: Sweep) -> int:
    """+1 where the sensor counts as the reference does, else -1."""
    return _slope(radians(sweep.reference_deg), radians(sweep.measured_deg), sweep.motion().turn)


def over_temperature(sweeps: Sequence[Sweep]) -> bool:
    """Whether all sweeps hold a temperature, and their temperatures differ enough for a law."""
    if any(sweep.temperature_c is None for sweep in sweeps):
        return False
    found = [temperature_of(sweep) for sweep in sweeps]
    return bool(found) and float(np.ptp(np.concatenate(found))) > SMALLEST_SPAN_K


def _slope(reference: Array, measured: Array, unit: IntArray) -> int:
    follows = []
    for sense in (1, -1):
        offset = measured - sense * reference
        follows.append(np.sum(np.hypot(np.bincount(unit, np.cos(offset)), np.bincount(unit, np.sin(offset)))))
    return 1 if follows[0] >= follows[1] else -1
