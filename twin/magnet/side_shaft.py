"""A sensor beside the magnet ("side shaft"): its die stands across the plane of the turn and sees radius and tangent.

There the two components of the field have different amplitudes, k = B_rad / B_tan, so that the angle computed from
them errs with order 2 by up to asin((k - 1) / (k + 1)), until the gain of the stronger one is trimmed by 1 / k.
Source: MPS MA702 data sheet Rev. 1.0, "side-shaft configuration", whose table 13 lists error and trim over k.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.limits import require_within
from twin.magnet.body_field import body_field
from twin.magnet.field import MT_PER_T
from twin.magnet.magnet import LARGEST_MM, Magnet
from twin.magnet.placement import turned


@dataclass(frozen=True, kw_only=True)
class SideShaft:
    """The sensor ``distance_mm`` from the shaft's axis and ``height_mm`` over the middle of the magnet."""

    distance_mm: float
    height_mm: float = 0.0

    def __post_init__(self) -> None:
        require_within("distance_mm", self.distance_mm, 0.1, LARGEST_MM, "mm")
        require_within("height_mm", self.height_mm, -LARGEST_MM, LARGEST_MM, "mm")


def side_channels_mT(place: SideShaft, magnet: Magnet, angle_rad: Array, *, temperature_c: float = 20.0) -> Array:
    """Radial and tangential field (2, n) [mT] of one magnet, centred on the shaft, at shaft angles (n,) [rad].

    The radial one counts inwards: then the angle of the two runs with the shaft, and is zero with it.
    """
    require_within("distance_mm", place.distance_mm, float(magnet.reach_mm), LARGEST_MM, "mm")
    angle = np.asarray(angle_rad, dtype=np.float64)
    sensor = np.broadcast_to([place.distance_mm, 0.0, place.height_mm], (angle.size, 3))
    # Magnetised along -x at theta = 0, as everywhere in this stage.
    field = turned(-body_field(magnet, turned(sensor, -angle)), angle)
    return np.asarray(MT_PER_T * magnet.remanence_at(temperature_c) * np.stack([-field[:, 0], field[:, 1]]))


def radial_over_tangential(place: SideShaft, magnet: Magnet) -> float:
    """k: amplitude of the radial field over that of the tangential one; both go round as the magnet does."""
    radial, tangential = side_channels_mT(place, magnet, np.array([0.0, 0.5 * np.pi]))
    return float(np.abs(radial[0] / tangential[1]))


def side_error_rad(k: float) -> float:
    """Largest angle error [rad] that amplitudes in the ratio ``k`` make, untrimmed."""
    return float(np.abs(np.arcsin((k - 1.0) / (k + 1.0))))
