"""Readings as a drive reads them, beside those without the faults of their words that a correction is made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.thermal.recording import Recording, joined
from twin.angles import Array, radians, wrap
from twin.decoded import Decoded
from twin.effect import BoolArray


@dataclass(frozen=True, eq=False)
class FaultOfWords:
    """What one fault did to the words of a recording: its cause, in words what it is, and the readings (n,) it touched.

    ``said`` begins with the sweep's name where there are several.
    """

    cause: str
    said: str
    touched: BoolArray


@dataclass(frozen=True, eq=False)
class AsRead:
    """All readings of one sensor: ``read`` as the drive reads them, ``told`` as they would be without faults of words.

    ``lost`` (n,) masks those of which nothing is left to be told: no correction is made of them.
    """

    read: Recording
    told: Recording
    lost: BoolArray
    faults: tuple[FaultOfWords, ...]

    @property
    def kept(self) -> Recording:
        """The readings without faults, of which something is left."""
        return self.told.part(~self.lost)

    @property
    def told_back(self) -> BoolArray:
        """Which readings (n,) a fault changed that can be told back, if with a zero of their own."""
        touched = np.zeros_like(self.lost)
        for fault in self.faults:
            touched |= fault.touched
        return touched & ~self.lost

    def kept_of(self, rows: BoolArray) -> Recording:
        """Those among some of the readings (n,)."""
        return self.told.part(rows & ~self.lost)

    def off_rad(self, fault: FaultOfWords) -> Array:
        """What a fault did to each reading (n,) [rad]; 0 where it did nothing."""
        return np.where(fault.touched, wrap(self.read.measured_rad - self.told.measured_rad), 0.0)


def as_read(sweeps: Sequence[Decoded]) -> AsRead:
    """The readings of sweeps, one after the other. Raises UserError where one of them counts the other way round."""
    told = joined([one.sweep for one in sweeps])
    read = replace(told, measured_rad=np.concatenate([radians(one.read.measured_deg) for one in sweeps]))
    lost = np.concatenate([one.lost for one in sweeps])
    return AsRead(read, told, lost, tuple(_faults(sweeps)))


def _faults(sweeps: Sequence[Decoded]) -> list[FaultOfWords]:
    total, start, found = sum(len(one.sweep) for one in sweeps), 0, []
    for one in sweeps:
        rows = slice(start, start + len(one.sweep))
        for (key, fault), said in zip(one.faults, one.said, strict=True):
            touched = np.zeros(total, dtype=bool)
            touched[rows] = fault.touched | fault.lost
            words = said.partition(": ")[2] or said
            name = "" if len(sweeps) == 1 else f"{one.sweep.name}: "
            found.append(FaultOfWords(key.partition("#")[0], name + words, touched))
        start = rows.stop
    return found
