"""SimpleFOC: the look-up table of CalibratedSensor (Arduino-FOC-drivers), offsets as floats.

The firmware takes the offset, interpolated between the two entries about the raw angle, off that angle; entry k stands
at k / n of a turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.correction.straight_lines import Least, Nodes, best_values
from diagnosis.correction.targets.target import Target, c_comment, numbers_of, rows
from diagnosis.correction.wanted import Wanted
from twin.angles import Array

_ARRAY = "calibrationLut"
_DECIMALS = 8


@dataclass(frozen=True, eq=False)
class SimpleFoc:
    """Offsets (n,) [rad] to be taken off the reading."""

    offset_rad: NDArray[np.float32]

    @classmethod
    def fitted(cls, wanted: Wanted, entries: int, least: Least) -> SimpleFoc:
        """The best table of so many entries."""
        return cls(-best_values(Nodes.even(entries), wanted.added, least).astype(np.float32))

    @classmethod
    def read(cls, text: str) -> SimpleFoc:
        """The table of a file."""
        return cls(numbers_of(text, _ARRAY).astype(np.float32))

    def __len__(self) -> int:
        return int(self.offset_rad.size)

    def corrected(self, reading_rad: Array) -> Array:
        """In single precision, as on the drive."""
        turn, count = np.float32(2.0 * np.pi), len(self)
        raw = np.mod(np.asarray(reading_rad), 2.0 * np.pi).astype(np.float32)
        width = turn / np.float32(count)
        # At the very end of the turn rounding leads to the entry behind the last, which is the first.
        left = (raw / width).astype(np.int64)
        share = (raw - left.astype(np.float32) * width) / width
        first, second = self.offset_rad[left % count], self.offset_rad[(left + 1) % count]
        return np.asarray(raw - ((np.float32(1.0) - share) * first + share * second), dtype=np.float64)

    def text(self, about: Sequence[str], name: str) -> str:
        """An array for the third argument of CalibratedSensor."""
        listed = rows([f"{value:.{_DECIMALS}f}f" for value in self.offset_rad], 8)
        return f"{c_comment(about)}float {_ARRAY}[{len(self)}] = {{\n    {listed}\n}};\n"


TARGET = Target(
    name="simplefoc",
    what="SimpleFOC, look-up table of CalibratedSensor (Arduino-FOC-drivers, table of floats)",
    ending=".h",
    axis="entry k at k/n of a turn of the sensor's own reading",
    sign="taken off the reading, linear in between",
    unit="rad",
    entries=200,
    fitted=SimpleFoc.fitted,
    read=SimpleFoc.read,
    load="include it and pass CalibratedSensor(sensor, n, calibrationLut); skip its calibrate(). The electrical zero "
    "and the sensor's direction stay the motor's own: align once with the table in place",
)
