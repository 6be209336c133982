"""The magnet that millimetres and millitesla are counted for, and the air gaps at which sweeps were recorded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from twin.angles import Array
from twin.errors import UserError
from twin.magnet.assembly import Assembly
from twin.magnet.field import series_by_group
from twin.magnet.magnet import Magnet
from twin.magnet.placement import LARGEST_GAP_MM, SMALLEST_GAP_MM, Placement

GAP_ERROR_MM = 0.05
"""Standard uncertainty of a stated air gap, that of a feeler gauge or a stage set by hand."""
UNSTATED_ERROR_MM = 0.5
"""That of the twin's own air gap where nobody has stated any."""


HELD_SHARE = 0.1
"""Of the field's change over the gaps, in logarithms: channels that change by less do not follow the field."""


HELD_WORDS = "vx and vy are of one size at all gaps, as an automatic gain makes them"
"""What is said of channels that do not follow the field."""


def held_at_one_size(amplitude: Array, *, field: Array) -> bool:
    """Whether channels (sweeps,) do not follow the field (sweeps,) of their gaps, each in any unit.

    An automatic gain, or a record in shares of the amplitude, holds the channels at one size. They are taken for such
    where they change by less than a tenth of what the field does.
    """
    return bool(np.ptp(np.log(amplitude)) <= HELD_SHARE * np.ptp(np.log(field)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Mounting:
    """The magnet on the shaft and the distance of the sensor from it.

    Attributes
    ----------
    magnet : twin.magnet.magnet.Magnet
        The magnet. Without one that of the twin is assumed, a cylinder of 6 mm x 2.5 mm.
    air_gap_mm : tuple of float
        Air gap of each sweep [mm]; of a single number that of the first sweep, from which the amplitudes of the raw
        channels tell the others.
    gap_error_mm : float
        Standard uncertainty of an air gap [mm].
    turned_deg : tuple of float
        By how much the sensor was turned about the shaft for each sweep [deg]; empty: not at all, as far as is known.
    assumed : bool
        Nobody has named a magnet: millimetres and millitesla are those of an assumed one.

    Raises
    ------
    twin.errors.UserError
        Where a number is out of range.
    """

    magnet: Magnet = field(default_factory=Magnet)
    air_gap_mm: tuple[float, ...] = (float(Placement().air_gap_mm),)
    gap_error_mm: float = GAP_ERROR_MM
    turned_deg: tuple[float, ...] = ()
    assumed: bool = False

    def __post_init__(self) -> None:
        if not self.air_gap_mm:
            raise UserError("found no air gap; give one of the first sweep, or one for each")
        for gap in self.air_gap_mm:
            Placement(air_gap_mm=gap)
        for turn in self.turned_deg:
            if not -360.0 <= turn <= 360.0:
                raise UserError(f"the sensor's turn (mounting) is {turn:g} deg; expected from -360 to 360")
        if not 0.0 < self.gap_error_mm < min(self.air_gap_mm):
            raise UserError(f"gap_error_mm is {self.gap_error_mm:g} mm; expected more than 0, and less than any gap")

    @classmethod
    def unstated(cls, magnet: Magnet | None = None) -> Mounting:
        """A magnet at an air gap that nobody has stated; without a magnet the twin's own, assumed."""
        return cls(magnet=magnet or Magnet(), gap_error_mm=UNSTATED_ERROR_MM, assumed=magnet is None)

    @classmethod
    def of(cls, assembly: Assembly) -> Mounting:
        """The magnet of a twin at the twin's own gap."""
        return cls(magnet=assembly.magnet, air_gap_mm=(float(assembly.placement.air_gap_mm),))

    def for_sweeps(self, sweeps: int) -> Mounting:
        """The same, checked to state one air gap or one for each sweep. Raises UserError."""
        if len(self.air_gap_mm) not in (1, sweeps):
            raise UserError(
                f"found {len(self.air_gap_mm)} air gaps for {sweeps} sweep{'s' if sweeps > 1 else ''}; "
                "expected one, or one for each sweep in their order"
            )
        return self

    @property
    def body(self) -> str:
        """The magnet in words."""
        magnet = self.magnet
        if magnet.shape == "block":
            return f"a block of {magnet.length_mm:g} x {magnet.width_mm:g} x {magnet.height_mm:g} mm"
        bore = f" with a bore of {magnet.bore_mm:g} mm" if magnet.shape == "ring" else ""
        return f"a {magnet.shape} of {magnet.diameter_mm:g} mm x {magnet.height_mm:g} mm{bore}"

    @cached_property
    def nominal_mT(self) -> float:
        """Field on the axis [mT] at the first air gap."""
        return float(self.field_mT(np.array(self.air_gap_mm[:1]))[0])

    def field_mT(self, gap_mm: Array) -> Array:
        """Field on the axis [mT] at air gaps (n,) [mm]."""
        return np.asarray(np.hypot(*coefficients(self.magnet, gap_mm)[:, :2, 1].T))

    def gaps_by_amplitude(self, amplitude: Sequence[float]) -> Array:
        """Air gaps [mm] of sweeps whose channels have these amplitudes, from the first one's stated gap."""
        first = self.air_gap_mm[0]
        farthest = min(20.0 * first + 2.0 * float(self.magnet.reach_mm), LARGEST_GAP_MM)
        gap = np.geomspace(max(0.05 * first, SMALLEST_GAP_MM), farthest, 400)
        strength = self.field_mT(gap)
        falling = np.flatnonzero(np.diff(strength) >= 0.0)
        start = int(falling[-1]) + 1 if falling.size else 0
        wanted = self.nominal_mT * np.asarray(amplitude) / amplitude[0]
        found = np.interp(-np.log(wanted), -np.log(strength[start:]), gap[start:])
        return np.asarray(found)


def coefficients(magnet: Magnet, gap_mm: Array, **placed: Array) -> Array:
    """Fourier coefficients (designs, 3, 2 orders + 1) [mT] of the field over a turn, at air gaps (designs,) [mm].

    In the order 1, cos, sin, cos 2, ...; ``placed`` are further numbers of :class:`Placement`, each (designs,).
    """
    placement = Placement(air_gap_mm=gap_mm, **placed)
    groups = list(series_by_group(magnet, placement))
    width = max(series.coefficients.shape[-1] for _, series in groups)
    out = np.zeros((gap_mm.size, 3, width))
    for rows, series in groups:
        out[rows, :, : series.coefficients.shape[-1]] = series.coefficients
    return out
