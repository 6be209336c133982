"""MagAlpha MA600 and MA600A: the 32-point correction table of the sensor itself, registers 0x20 to 0x3F.

Each register holds a two's complement of 8 bit in steps of 360/4096 deg, +-11.25 deg in all; the sensor adds what a
straight line between the two points about its angle says.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.correction.straight_lines import Least, Nodes, best_whole_numbers
from diagnosis.correction.targets.target import Target, c_comment, numbers_of, rows
from diagnosis.correction.wanted import Wanted
from twin.angles import TAU, Array, IntArray
from twin.errors import UserError

_POINTS = 32
_STEP_RAD = TAU / 4096
_LARGEST = 127
_ARRAY = "correction"


@dataclass(frozen=True, eq=False)
class MagAlpha:
    """Steps (32,) to be added."""

    step: IntArray

    @classmethod
    def fitted(cls, wanted: Wanted, entries: int, least: Least) -> MagAlpha:
        """The best table. Raises UserError where the correction is more than a register holds."""
        nodes = Nodes.even(entries)
        largest = float(np.max(np.abs(wanted.added(nodes.at_rad))))
        if largest > _LARGEST * _STEP_RAD:
            raise UserError(
                f"the correction is {np.degrees(largest):.1f} deg, and a register of the MA600 holds "
                f"{np.degrees(_LARGEST * _STEP_RAD):.1f} deg; trim the sensor (BCT) or place it better, "
                "and measure again"
            )
        return cls(best_whole_numbers(nodes, wanted.added, _STEP_RAD, least=least, limit=_LARGEST))

    @classmethod
    def read(cls, text: str) -> MagAlpha:
        """The table of a file."""
        byte = numbers_of(text, _ARRAY).astype(np.int64)
        return cls(np.where(byte > _LARGEST, byte - 256, byte))

    def __len__(self) -> int:
        return int(self.step.size)

    def corrected(self, reading_rad: Array) -> Array:
        """Interpolated without rounding: how the sensor rounds within a step of its output is not published."""
        reading, count = np.mod(np.asarray(reading_rad), TAU), len(self)
        place = reading / TAU * count
        left = np.minimum(place.astype(np.int64), count - 1)
        share = place - left
        return np.asarray(
            reading + _STEP_RAD * (self.step[left] * (1.0 - share) + self.step[(left + 1) % count] * share)
        )

    def text(self, about: Sequence[str], name: str) -> str:
        """The bytes of the registers."""
        listed = rows([str(value) for value in self.step % 256], 8)
        return (
            f"{c_comment(about)}#include <stdint.h>\n\n"
            f"/* Registers 0x20 to 0x3F, two's complement. */\n"
            f"static const uint8_t {_ARRAY}[{len(self)}] = {{\n    {listed}\n}};\n"
        )


TARGET = Target(
    name="magalpha",
    what="MPS MagAlpha MA600 and MA600A, correction table of the sensor (the types before them have none)",
    ending=".h",
    axis="point k at k/32 of a turn of the sensor's own angle",
    sign="added by the sensor, linear in between",
    unit="360/4096 deg, 8-bit two's complement",
    entries=_POINTS,
    fewest=_POINTS,
    most=_POINTS,
    fitted=MagAlpha.fitted,
    read=MagAlpha.read,
    load="write byte k to register 0x20 + k, and store block 1; record with these registers at 0, and with the BCT, "
    "zero and direction that stay",
)
