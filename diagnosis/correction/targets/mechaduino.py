"""Mechaduino: the look-up table of the firmware, a shaft angle in degrees for each of the 16,384 encoder counts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.correction.straight_lines import Least
from diagnosis.correction.targets.target import Target, c_comment, numbers_of, rows
from diagnosis.correction.wanted import Wanted
from twin.angles import TAU, Array, radians

_COUNTS = 16384
_ARRAY = "lookup"


@dataclass(frozen=True, eq=False)
class Mechaduino:
    """Shaft angles (16384,) [deg], one a count."""

    angle_deg: NDArray[np.float32]

    @classmethod
    def fitted(cls, wanted: Wanted, entries: int, least: Least) -> Mechaduino:
        """The shaft angle at each count: no line is drawn in between, so that the curve itself is the best table."""
        angle = np.round(np.degrees(wanted.shaft(TAU * np.arange(entries) / entries)), 4) % 360.0
        return cls(angle.astype(np.float32))

    @classmethod
    def read(cls, text: str) -> Mechaduino:
        """The table of a file."""
        return cls(numbers_of(text, _ARRAY).astype(np.float32))

    def __len__(self) -> int:
        return int(self.angle_deg.size)

    def corrected(self, reading_rad: Array) -> Array:
        """The entry of the nearest count."""
        count = np.round(np.asarray(reading_rad) / TAU * len(self)).astype(np.int64) % len(self)
        return radians(self.angle_deg[count])

    def text(self, about: Sequence[str], name: str) -> str:
        """The array of Parameters.cpp."""
        listed = rows([f"{value:.4f}" for value in self.angle_deg], 16)
        declared = f"const float __attribute__((__aligned__(256))) {_ARRAY}[{len(self)}]"
        return f"{c_comment(about)}{declared} = {{\n    {listed}\n}};\n"


TARGET = Target(
    name="mechaduino",
    what="Mechaduino, look-up table of Parameters.cpp",
    ending=".h",
    axis="one entry for each of the 16,384 counts of the encoder's own reading",
    sign="the entry is the shaft angle, no line in between",
    unit="deg",
    entries=_COUNTS,
    fewest=_COUNTS,
    most=_COUNTS,
    absolute=True,
    fitted=Mechaduino.fitted,
    read=Mechaduino.read,
    load="put the array in the place of lookup in Parameters.cpp; the reference's zero must be the motor's step zero, "
    "and it must count as the steps do, else the phases are driven at a wrong angle",
)
