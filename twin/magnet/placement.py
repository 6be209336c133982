"""Placement: where magnet and sensor sit. The one place for the stage's sign and axis conventions.

The stator frame has its origin in the nominal centre of the magnet, z along the shaft's axis towards the sensor,
and angles counted right-handed about z. Lengths are in mm, angles of tilts in deg, fields in mT.

- The magnet turns with the shaft by theta. At theta = 0 it is magnetised along -x, so that the field at a sensor on
  the axis, outside the face, points along +x: the angle counted is that of the field.
- ``magnet_x_mm``, ``magnet_y_mm``: centre of the magnet off the shaft's axis at theta = 0; it goes round with it.
- ``magnet_tilt_x_deg``, then ``magnet_tilt_y_deg``: rotations of the magnet about its centre, about the x and then the
  y axis of the shaft at theta = 0; they go round with the shaft too.
- ``sensor_x_mm``, ``sensor_y_mm``: sensor off the shaft's axis, fixed in the stator.
- ``sensor_tilt_x_deg``, then ``sensor_tilt_y_deg``: rotations of the sensor's axes about those of the stator.
- ``air_gap_mm``: from the face of the untilted magnet to the sensing plane, along z.
- ``stray_x_mT`` ...: a uniform field fixed in the stator.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from twin.angles import Array
from twin.limits import OutOfRangeError, require_within
from twin.magnet.magnet import Magnet, Number

LARGEST_TILT_DEG = 60.0
SMALLEST_GAP_MM = 1e-3
LARGEST_GAP_MM = 200.0
LARGEST_SHIFT_MM = 100.0
LARGEST_STRAY_MT = 1000.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Placement:
    """See the module's text; every number may be an array of shape (designs,)."""

    air_gap_mm: Number = 1.5
    sensor_x_mm: Number = 0.0
    sensor_y_mm: Number = 0.0
    sensor_tilt_x_deg: Number = 0.0
    sensor_tilt_y_deg: Number = 0.0
    magnet_x_mm: Number = 0.0
    magnet_y_mm: Number = 0.0
    magnet_tilt_x_deg: Number = 0.0
    magnet_tilt_y_deg: Number = 0.0
    stray_x_mT: Number = 0.0
    stray_y_mT: Number = 0.0
    stray_z_mT: Number = 0.0

    def __post_init__(self) -> None:
        require_within("air_gap_mm", self.air_gap_mm, SMALLEST_GAP_MM, LARGEST_GAP_MM, "mm")
        for item in fields(self):
            value = getattr(self, item.name)
            if "tilt" in item.name:
                require_within(item.name, value, -LARGEST_TILT_DEG, LARGEST_TILT_DEG, "deg")
            elif item.name.startswith("stray"):
                require_within(item.name, value, -LARGEST_STRAY_MT, LARGEST_STRAY_MT, "mT")
            elif item.name != "air_gap_mm":
                require_within(item.name, value, -LARGEST_SHIFT_MM, LARGEST_SHIFT_MM, "mm")

    @property
    def magnet_mm(self) -> Array:
        """Centre of the magnet off the axis at theta = 0 (..., 3) [mm]."""
        return _vector(self.magnet_x_mm, self.magnet_y_mm, 0.0)

    @property
    def magnet_axes(self) -> Array:
        """Columns: the magnet's axes in the shaft's frame (..., 3, 3)."""
        return _tilt(self.magnet_tilt_x_deg, self.magnet_tilt_y_deg)

    @property
    def sensor_axes(self) -> Array:
        """Columns: the sensor's axes in the stator's frame (..., 3, 3)."""
        return _tilt(self.sensor_tilt_x_deg, self.sensor_tilt_y_deg)

    @property
    def stray_mT(self) -> Array:
        """Stray field in the stator's frame (..., 3) [mT]."""
        return _vector(self.stray_x_mT, self.stray_y_mT, self.stray_z_mT)

    def mirrored(self) -> Placement:
        """The placement seen in a mirror along the x axis: the field's y changes sign where the shaft turns back.

        A mirror turns the sense of a magnetisation too, which the counted angle leaves as it was: so does the stray
        field keep its x and z.
        """
        turned = ("sensor_y_mm", "sensor_tilt_x_deg", "magnet_y_mm", "magnet_tilt_x_deg", "stray_y_mT")
        return replace(self, **{name: -np.asarray(getattr(self, name))[()] for name in turned})

    def sensor_mm(self, magnet: Magnet) -> Array:
        """The sensor in the stator's frame (..., 3) [mm]."""
        height = np.asarray(self.air_gap_mm) + 0.5 * np.asarray(magnet.height_mm)
        return _vector(self.sensor_x_mm, self.sensor_y_mm, height)


def designs_of(magnet: Magnet, placement: Placement) -> tuple[int, ...]:
    """The common shape of all numbers: () for one design, (designs,) for many."""
    values = [getattr(part, item.name) for part in (magnet, placement) for item in fields(part)]
    shapes = [np.shape(value) for value in values if not isinstance(value, str | None)]
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError:
        raise OutOfRangeError(
            f"numbers of designs are {sorted(set(shapes))}; expected one common shape (designs,)"
        ) from None


def turned(vector: Array, angle: Array) -> Array:
    """Vectors (..., 3) turned about z by the angle [rad] (...)."""
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = vector[..., 0], vector[..., 1], vector[..., 2]
    return _vector(c * x - s * y, s * x + c * y, z)


def _vector(x: Number, y: Number, z: Number) -> Array:
    return np.stack(np.broadcast_arrays(*(np.asarray(v, dtype=np.float64) for v in (x, y, z))), axis=-1)


def _tilt(x_deg: Number, y_deg: Number) -> Array:
    """Rotation about x, then about the fixed y axis (..., 3, 3)."""
    a, b = np.broadcast_arrays(np.radians(x_deg), np.radians(y_deg))
    ca, sa, cb, sb, zero = np.cos(a), np.sin(a), np.cos(b), np.sin(b), np.zeros_like(a)
    rows = [[cb, sb * sa, sb * ca], [zero, ca, -sa], [-sb, cb * sa, cb * ca]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
