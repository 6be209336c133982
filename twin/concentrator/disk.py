"""The concentrator as a disk over four plates: gain, in-plane to vertical conversion, and errors of its placement.

A soft magnetic disk draws an in-plane field in at one edge and lets it out at the other, so the vertical field under
its edge goes with the cosine of the azimuth from the field. Two plates on opposite edges, subtracted, make a channel.
Source: R. S. Popovic et al., Sensors and Actuators A 91 (2001) 46 (magnetic concentrator over Hall plates); the
paper, section 2.1, for shift and rough edge. The defaults are typical assumptions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.limits import require_within

PLATES = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
"""Directions of the plates from the die's centre: x+, x-, y+, y-."""


@dataclass(frozen=True, kw_only=True)
class Disk:
    """``gain`` is vertical over in-plane field under the edge, where the vertical field is largest.

    Beside the edge it falls off as a Gaussian of the width ``falloff_um``.
    ``shift_x_um``, ``shift_y_um``: the disk's centre off the die's. ``roughness_um``: RMS of the local edge about the
    circle; ``part`` is the seed that draws it. ``saturation_mT`` is the in-plane field at which a tanh-shaped
    magnetisation curve levels off.
    """

    gain: float = 6.0
    radius_um: float = 100.0
    falloff_um: float = 20.0
    shift_x_um: float = 0.0
    shift_y_um: float = 0.0
    roughness_um: float = 0.0
    part: int = 0
    saturation_mT: float = 500.0

    def __post_init__(self) -> None:
        require_within("gain", self.gain, 0.1, 100.0)
        require_within("radius_um", self.radius_um, 1.0, 1e4, "um")
        require_within("falloff_um", self.falloff_um, 0.1, 1e4, "um")
        for name in ("shift_x_um", "shift_y_um"):
            require_within(name, getattr(self, name), -0.5 * self.radius_um, 0.5 * self.radius_um, "um")
        require_within("roughness_um", self.roughness_um, 0.0, 0.1 * self.radius_um, "um")
        require_within("part", self.part, 0, 2**32 - 1, whole=True)
        require_within("saturation_mT", self.saturation_mT, 1.0, 1e4, "mT")

    @property
    def plate_gains(self) -> Array:
        """Vertical field at each plate for unit in-plane fields along x and y (4, 2)."""
        out = PLATES * self.radius_um - np.array([self.shift_x_um, self.shift_y_um])
        distance = np.linalg.norm(out, axis=1)
        rough = np.random.default_rng(self.part).standard_normal((2, 4)) * self.roughness_um
        # A dent moves the edge by the first draw, and turns it by the second over about a fall-off's width.
        off_edge = distance - (self.radius_um + rough[0])
        turn = np.arctan2(out[:, 1], out[:, 0]) + np.arctan(rough[1] / self.falloff_um)
        size = self.gain * np.exp(-0.5 * (off_edge / self.falloff_um) ** 2)
        return np.asarray(size[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1))

    @property
    def conversion(self) -> Array:
        """The channels' vertical field for unit in-plane fields (2, 2): half the difference of opposite plates."""
        gains = self.plate_gains
        return np.asarray(0.5 * (gains[0::2] - gains[1::2]))

    @property
    def orthogonality_deg(self) -> float:
        """By how much the channels' axes are short of a right angle [deg]: beta of the effect ``phase``.

        y senses the angle a + beta where its axis is turned by -beta.
        """
        x, y = self.conversion
        between = np.arctan2(y[1], y[0]) - np.arctan2(x[1], x[0])
        return float(90.0 - np.degrees(between))

    @property
    def axis_deg(self) -> float:
        """Direction of the x channel's axis on the die [deg]: minus ``zero_deg`` of the effect ``zero``."""
        x, _ = self.conversion
        return float(np.degrees(np.arctan2(x[1], x[0])))

    @property
    def ratio(self) -> float:
        """Sensitivity of y over that of x: ``ratio`` of the effect ``gain_mismatch``."""
        x, y = np.linalg.norm(self.conversion, axis=1)
        return float(y / x)

    def k_percent(self, field_mT: float) -> float:
        """``k_percent`` of the effect ``saturation`` at this amplitude [mT]: the cubic term of tanh, (B / Bs)^2 / 3."""
        return float(100.0 / 3.0 * (field_mT / self.saturation_mT) ** 2)


def vertical_mT(in_plane_mT: Array, disk: Disk) -> Array:
    """Vertical field (..., 2, n) [mT] of the two channels under an in-plane field (..., 2, n) [mT], unsaturated."""
    return np.asarray(disk.conversion @ in_plane_mT)
