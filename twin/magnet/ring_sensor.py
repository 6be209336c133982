"""A ring of Hall plates that lie in the die and sense the field upright on it: an end-of-shaft sensor without a disk.

Over a magnet magnetised across its axis the upright field goes with the cosine of the azimuth about that axis, so the
first harmonic over plates on a circle turns with the magnet. A uniform stray field is the same at all of them and falls
out. Source: RLS AM4096 data sheet D02_05, ams AS5048 data sheet v1-11, which sense by such a ring of 1.0 and 1.1 mm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from twin.angles import TAU, Array
from twin.limits import require_within
from twin.magnet.field import field_mT
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement, designs_of


@dataclass(frozen=True, kw_only=True)
class RingSensor:
    """``plates`` Hall plates, evenly on a circle of ``radius_mm`` about the die's centre, the first on its x axis."""

    radius_mm: float = 1.0
    plates: int = 4

    def __post_init__(self) -> None:
        require_within("radius_mm", self.radius_mm, 1e-3, 20.0, "mm")
        # Fewer than three cannot tell two axes and a uniform field apart.
        require_within("plates", self.plates, 3, 1024, whole=True)

    @property
    def azimuth_rad(self) -> Array:
        """Where the plates stand, from the die's x axis (plates,)."""
        return np.asarray(np.arange(self.plates) * (TAU / self.plates), dtype=np.float64)


def ring_channels_mT(
    sensor: RingSensor, magnet: Magnet, placement: Placement, angle_rad: Array, *, temperature_c: float = 20.0
) -> Array:
    """x and y of the ring (2, n) [mT] for one design at shaft angles (n,) [rad]: first harmonic of the upright field.

    Signs are such that a centred magnet's ring reads the shaft angle. The ring tilts with the die.
    """
    if designs_of(magnet, placement):
        raise ValueError("one design is expected")
    azimuth = sensor.azimuth_rad
    on_die = sensor.radius_mm * np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(azimuth.size)])
    x, y, up = placement.sensor_axes @ on_die
    each = replace(
        placement,
        sensor_x_mm=placement.sensor_x_mm + x,
        sensor_y_mm=placement.sensor_y_mm + y,
        air_gap_mm=placement.air_gap_mm + up,
    )
    upright = field_mT(magnet, each, np.asarray(angle_rad), temperature_c=temperature_c)[:, 2]
    # The field points along +x on the axis at theta = 0, so its lines leave the magnet at -x and come back at +x.
    return np.asarray(-2.0 / sensor.plates * np.stack([np.cos(azimuth), np.sin(azimuth)]) @ upright)
