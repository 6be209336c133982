"""moteus: the encoder's compensation table of a source, in fractions of a turn that are added to its value.

Firmware with 256 whole numbers and one scale interpolates between entries at k/256 of a turn; firmware with 32 floats,
which came before it, between the middles of its 32 bins.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.correction.straight_lines import Least, Nodes, best_values, best_whole_numbers
from diagnosis.correction.targets.target import Target, hash_comment
from diagnosis.correction.wanted import Wanted
from twin.angles import TAU, Array, IntArray

_LARGEST = 127
_BINS = 32
_TABLE = "motor_position.sources.0.compensation_table"
_SCALE = "motor_position.sources.0.compensation_scale"


@dataclass(frozen=True, eq=False)
class Moteus:
    """Entries (256,): parts of 127 of the scale, which is a fraction of a turn."""

    entry: IntArray
    scale: np.float32

    @classmethod
    def fitted(cls, wanted: Wanted, entries: int, least: Least) -> Moteus:
        """The best table."""
        nodes = Nodes.even(entries)
        largest = float(np.max(np.abs(best_values(nodes, wanted.added, least)))) / TAU
        # A scale of 0 would switch the table off.
        scale = np.float32(max(largest, 1e-9))
        unit = TAU * float(scale) / _LARGEST
        return cls(best_whole_numbers(nodes, wanted.added, unit, least=least, limit=_LARGEST), scale)

    @classmethod
    def read(cls, text: str) -> Moteus:
        """The table of a file. Raises ValueError where it sets no scale."""
        scale = re.search(rf"^{re.escape(_SCALE)} (\S+)", text, re.MULTILINE)
        if scale is None:
            raise ValueError("no scale")
        return cls(np.array(_entries(text), dtype=np.int64), np.float32(scale[1]))

    def __len__(self) -> int:
        return int(self.entry.size)

    def corrected(self, reading_rad: Array) -> Array:
        """In single precision, as on the drive."""
        ratio, count = np.mod(np.asarray(reading_rad) / TAU, 1.0).astype(np.float32), len(self)
        left = np.minimum(count - 1, (ratio * np.float32(count)).astype(np.int64))
        share = (ratio - left.astype(np.float32) / np.float32(count)) * np.float32(count)
        part = self.entry.astype(np.float32) * (self.scale / np.float32(_LARGEST))
        added = part[left] * (np.float32(1.0) - share) + part[(left + 1) % count] * share
        return np.asarray(TAU * (ratio.astype(np.float64) + added))

    def text(self, about: Sequence[str], name: str) -> str:
        """Lines for moteus_tool --restore-config."""
        lines = [f"{_TABLE}.{k} {value}\n" for k, value in enumerate(self.entry)]
        return hash_comment(about) + "".join(lines) + f"{_SCALE} {self.scale:.9g}\n"


@dataclass(frozen=True, eq=False)
class MoteusOfFloats:
    """Fractions of a turn (32,), each at the middle of its bin."""

    fraction: NDArray[np.float32]

    def __len__(self) -> int:
        return int(self.fraction.size)

    def corrected(self, reading_rad: Array) -> Array:
        """In single precision, as on the drive."""
        ratio = np.mod(np.asarray(reading_rad) / TAU, 1.0)
        place = np.mod(ratio * _BINS - 0.5, _BINS)
        left = np.minimum(place.astype(np.int64), _BINS - 1)
        share = (place - left).astype(np.float32)
        first, second = self.fraction[left], self.fraction[(left + 1) % _BINS]
        return np.asarray(TAU * (ratio + ((second - first) * share + first)))

    def text(self, about: Sequence[str], name: str) -> str:
        """Lines for moteus_tool --restore-config."""
        lines = [f"{_TABLE}.{k} {value:.9g}\n" for k, value in enumerate(self.fraction)]
        return hash_comment(about) + "".join(lines)

    @classmethod
    def fitted(cls, wanted: Wanted, entries: int, least: Least) -> MoteusOfFloats:
        """The best table."""
        values = best_values(Nodes.even(entries, 0.5), wanted.added, least) / TAU
        return cls(values.astype(np.float32))

    @classmethod
    def read(cls, text: str) -> MoteusOfFloats:
        """The table of a file."""
        return cls(np.array(_entries(text), dtype=np.float32))


def _entries(text: str) -> list[float]:
    """The entries that a file sets, in the order in which they stand."""
    return [float(found) for found in re.findall(rf"^{re.escape(_TABLE)}\.\d+ (\S+)", text, re.MULTILINE)]


_LOAD = (
    "moteus_tool --restore-config FILE; it is for source 0 with offset 0 and sign 1: with others, the table stands on "
    "the value after them. Then calibrate the motor again, as its commutation was measured without the table"
)
TARGET = Target(
    name="moteus",
    what="moteus, compensation table of an encoder source, 256 whole numbers and a scale",
    ending=".cfg",
    axis="entry k at k/256 of a turn of the source's value",
    sign="added to the value, linear in between",
    unit="1/127 of the scale, which is a fraction of a turn",
    entries=256,
    fewest=256,
    most=256,
    fitted=Moteus.fitted,
    read=Moteus.read,
    load=_LOAD,
)
OF_FLOATS = Target(
    name="moteus",
    what="moteus, compensation table of an encoder source, 32 floats, as in firmware before the one with 256 entries",
    ending=".cfg",
    axis="entry k at the middle of bin k of 32, on the source's value",
    sign="added to the value, linear in between",
    unit="fractions of a turn",
    entries=_BINS,
    fewest=_BINS,
    most=_BINS,
    fitted=MoteusOfFloats.fitted,
    read=MoteusOfFloats.read,
    load=_LOAD,
)
