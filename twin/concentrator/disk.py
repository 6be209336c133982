"""The concentrator as a disk over four plates: gain, in-plane to vertical conversion, and errors of its placement.

A soft magnetic disk draws an in-plane field in at one edge and lets it out at the other, so the vertical field under
its edge goes with the cosine of the azimuth from the field. Two plates on opposite edges, subtracted, make a channel.
Source: R. S. Popovic et al., Sensors and Actuators A 91 (2001) 46 (magnetic concentrator over Hall plates); the
paper, section 2.1, for shift and rough edge. The defaults are typical assumptions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Parameters
from twin.limits import OutOfRangeError, require_within
from twin.motion import Motion
from twin.part import part, per_design

TINY_MT = 1e-300
"""In place of a field of zero, whose direction nothing asks for."""

PLATES = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
"""Directions of the plates from the die's centre: x+, x-, y+, y-."""


@dataclass(frozen=True, kw_only=True)
class Disk:
    """``gain`` is vertical over in-plane field under the edge, where the vertical field is largest.

    Beside the edge it falls off as a Gaussian of the width ``falloff_um``.
    ``shift_x_um``, ``shift_y_um``: the disk's centre off the die's. ``roughness_um``: RMS of the local edge about the
    circle; ``part`` is the seed that draws it. ``saturation_mT`` is the in-plane field at which a tanh-shaped
    magnetisation curve levels off; infinite: it never does. ``per_axis`` is the share of the saturation's leading term
    that each channel suffers from its own component, as where the disk saturates under its edges first; the rest acts
    on the length of the field's vector, as in an even disk, and turns no angle. No source gives the share; the default
    is what the paper's Eq. 5 takes, a curve for each axis. A gain of 1 is no disk: the plates see the field as it is.
    """

    gain: float = 6.0
    radius_um: float = 100.0
    falloff_um: float = 20.0
    shift_x_um: float = 0.0
    shift_y_um: float = 0.0
    roughness_um: float = 0.0
    part: int = 0
    saturation_mT: float = math.inf
    per_axis: float = 1.0

    def __post_init__(self) -> None:
        require_within("gain", self.gain, 0.1, 100.0)
        require_within("radius_um", self.radius_um, 1.0, 1e4, "um")
        require_within("falloff_um", self.falloff_um, 0.1, 1e4, "um")
        for name in ("shift_x_um", "shift_y_um"):
            require_within(name, getattr(self, name), -0.5 * self.radius_um, 0.5 * self.radius_um, "um")
        require_within("roughness_um", self.roughness_um, 0.0, 0.1 * self.radius_um, "um")
        require_within("part", self.part, 0, 2**32 - 1, whole=True)
        if self.saturation_mT != math.inf:
            require_within("saturation_mT", self.saturation_mT, 1.0, 1e4, "mT")
            if self.gain == 1.0:
                raise OutOfRangeError(
                    f"saturation_mT is {self.saturation_mT:g} mT at a gain of 1, which is no disk and does not "
                    "saturate; expected another gain, or no saturation_mT"
                )
        require_within("per_axis", self.per_axis, 0.0, 1.0)

    @property
    def ideal(self) -> bool:
        """Whether its channels are the field's components, times the gain."""
        centred = self.shift_x_um == self.shift_y_um == self.roughness_um == 0.0
        return centred and self.saturation_mT == math.inf

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

    @cached_property
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
        return float(self.per_axis * 100.0 / 3.0 * (field_mT / self.saturation_mT) ** 2)


def vertical_mT(in_plane_mT: Array, disk: Disk) -> Array:
    """Vertical field (..., 2, n) [mT] of the two channels under an in-plane field (..., 2, n) [mT].

    The leading terms of the two curves, B |B|^2 (1 - per_axis) / (3 Bs^2) and B_i^3 per_axis / (3 Bs^2), add up.
    """
    if disk.saturation_mT == math.inf:
        return np.asarray(disk.conversion @ in_plane_mT)
    length = np.linalg.norm(in_plane_mT, axis=-2, keepdims=True)
    whole, each = (_bent(disk.saturation_mT, share) for share in (1.0 - disk.per_axis, disk.per_axis))
    along = in_plane_mT * (whole(length) / np.maximum(length, TINY_MT))
    return np.asarray(disk.gain * each(disk.conversion @ along / disk.gain))


def _bent(saturation_mT: float, share: float) -> Callable[[Array], Array]:
    """A tanh whose cubic term is this share of that of the whole saturation."""
    if share == 0.0:
        return np.asarray
    level = saturation_mT / math.sqrt(share)
    return lambda field: np.asarray(level * np.tanh(field / level))


def described(disk: Disk, nominal_mT: Any) -> Effect:
    """The disk as an operation on channels whose amplitude 1 stands for ``nominal_mT`` (or one a design) in the plane.

    Behind it the amplitude 1 stands for ``gain`` times as many millitesla under the disk.
    """
    scale = per_design(nominal_mT)

    def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        return vertical_mT(scale * signal, disk) / (disk.gain * scale)

    return part("disk", "concentrator", forward, "the concentrator's disk as described in [hardware.disk]")
