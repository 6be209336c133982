"""Several recordings of one device: which one each reading belongs to, and how the bench was set up in each."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from twin.angles import Array, IntArray


@dataclass(frozen=True, kw_only=True)
class Setup:
    """How the bench was set up for one recording.

    Attributes
    ----------
    name : str
        What messages call the recording: the name of its file.
    air_gap_mm : float or None
        From the magnet's face to the sensing plane [mm]; None where nobody has stated it.
    turned_deg : float
        By how much the sensor was turned about the shaft since the first recording [deg], counted as the sensor's
        axes count angles.
    reference_deg : float
        By how much the reference has counted on from where it stood in the first recording [deg]: its zero was found
        anew meanwhile.
    turn_stated_deg : float or None
        The same turn as it was stated, in whichever sense; None where nobody has stated any.
    turn_told : bool
        Whether ``turned_deg`` is told by the readings alone.
    field, distance : float
        The magnet's field at the sensor, and the distance from its centre, against those of the first recording.
    amplitude_held : bool
        Whether vx and vy are of one size at all gaps, so that the magnet alone tells the field.
    offset_ratio : float or None
        Where no gap is stated: the offset over that of the first recording, if either is more than noise, both point
        the same way, and one is the larger beyond the noise, by a factor of 10 at most, as in another field; else None.
    """

    name: str = ""
    air_gap_mm: float | None = None
    turned_deg: float = 0.0
    reference_deg: float = 0.0
    turn_stated_deg: float | None = None
    turn_told: bool = False
    field: float = 1.0
    distance: float = 1.0
    amplitude_held: bool = False
    offset_ratio: float | None = None

    @property
    def turn_contradicted(self) -> bool:
        """Whether a turn of the sensor was stated that does not agree with the zero."""
        return bool(self.turn_stated_deg) and self.reference_deg != 0.0


@dataclass(frozen=True, eq=False)
class Recordings:
    """Recordings of one device, one behind the other.

    Attributes
    ----------
    number : ndarray
        Number of the recording of each reading (n,), from 0, never falling.
    setups : tuple of Setup
        How the bench was set up in each.
    left_out : tuple of str
        Columns that only some recordings have, so that none is used.
    """

    number: IntArray
    setups: tuple[Setup, ...]
    left_out: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.setups)

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """The rows of each recording."""
        edges = np.searchsorted(self.number, np.arange(len(self.setups) + 1)).tolist()
        return tuple(slice(first, last) for first, last in itertools.pairwise(edges))

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """How many readings each recording has."""
        return tuple(rows.stop - rows.start for rows in self.slices)

    @cached_property
    def turned_rad(self) -> Array:
        """By how much the sensor was turned about the shaft [rad], for each reading (n,)."""
        turned_deg: Array = np.array([setup.turned_deg for setup in self.setups], dtype=np.float64)
        return np.asarray(np.radians(turned_deg)[self.number])

    def part(self, rows: IntArray) -> Recordings:
        """The recordings of these rows (m,), in rising order; those without a row are left out."""
        left, number = np.unique(self.number[rows], return_inverse=True)
        return Recordings(number.astype(np.int64), tuple(self.setups[k] for k in left), self.left_out)
