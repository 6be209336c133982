"""A magnet and its placement: the field that drives the two channels of a chain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from twin.angles import Array, channels_of
from twin.limits import OutOfRangeError
from twin.magnet.field import Series, series_of
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement, designs_of
from twin.motion import NOMINAL_C, Motion
from twin.shown import shown
from twin.tables import from_table, to_table


@dataclass(frozen=True, eq=False)
class Assembly:
    """One magnet in one place. The nominal amplitude 1 is the field on the axis, untilted, at the same air gap."""

    magnet: Magnet = field(default_factory=Magnet)
    placement: Placement = field(default_factory=Placement)

    def __post_init__(self) -> None:
        if designs_of(self.magnet, self.placement):
            raise OutOfRangeError("the magnet of a chain is one design; expected single numbers")

    @cached_property
    def series(self) -> Series:
        """The field in the sensor's axes over a turn [mT] at 25 C, stray field included."""
        return series_of(self.magnet, self.placement, temperature_c=NOMINAL_C)

    @cached_property
    def nominal_mT(self) -> float:
        """Field [mT] on the axis, untilted, without stray field, at 25 C."""
        ideal = Placement(air_gap_mm=self.placement.air_gap_mm)
        return float(series_of(self.magnet, ideal, temperature_c=NOMINAL_C).coefficients[0, 1])

    @property
    def distance_mm(self) -> Any:
        """From the centre of the untilted magnet to the sensing plane, along the shaft."""
        return np.asarray(self.placement.air_gap_mm) + 0.5 * np.asarray(self.magnet.height_mm)

    def warm(self, temperature_c: Array) -> Array:
        """Magnetisation at these temperatures (n,) over that at 25 C."""
        return np.asarray(self.magnet.remanence_at(temperature_c) / self.magnet.remanence_at(NOMINAL_C))

    def channels(self, angle_rad: Array, motion: Motion) -> Array:
        """x and y (..., 2, n) of nominal amplitude 1 at the field angles [rad] (..., 2, n), by the magnet's field.

        The magnet's own part follows the temperature of each reading; the stray field does not.
        """
        warm = self.warm(motion.temperature_c)
        stray = self.placement.stray_mT @ self.placement.sensor_axes
        x, y = (
            (self.series.component(axis, angle_rad[..., axis : axis + 1, :]) - stray[axis]) * warm + stray[axis]
            for axis in (0, 1)
        )
        return channels_of(x, y) / self.nominal_mT


def assembly_from(content: Any) -> Assembly:
    """The assembly of a twin file's [magnet] table; its numbers of place stand in [magnet.placement].

    Raises OutOfRangeError for an unknown name or a number out of range.
    """
    if not isinstance(content, Mapping):
        raise OutOfRangeError(f"magnet is {shown(content)}; expected a table")
    body = {key: value for key, value in content.items() if key != "placement"}
    place = from_table(Placement, content.get("placement", {}), "magnet.placement")
    return Assembly(from_table(Magnet, body, "magnet"), place)


def assembly_table(assembly: Assembly) -> dict[str, Any]:
    """The [magnet] table of a twin file: what differs from the defaults, and the shape."""
    table: dict[str, Any] = {"shape": assembly.magnet.shape, **to_table(assembly.magnet)}
    place = to_table(assembly.placement)
    return {**table, **({"placement": place} if place else {})}
