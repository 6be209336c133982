"""A plain table as CSV, for whatever interpolates linearly between even steps of the reading."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.correction.straight_lines import Least, Nodes, best_values
from diagnosis.correction.targets.target import Target
from diagnosis.correction.wanted import Wanted
from twin.angles import TAU, Array, radians, wrap

_HEAD = "reading_deg,correction_deg,shaft_deg"


@dataclass(frozen=True, eq=False)
class Lut:
    """Shaft angles (n,) [deg] at even steps of the reading, and in them the corrections [deg]."""

    correction_deg: Array
    shaft_deg: Array

    @classmethod
    def fitted(cls, wanted: Wanted, entries: int, least: Least) -> Lut:
        """The best table of so many rows."""
        nodes = Nodes.even(entries)
        added = best_values(nodes, wanted.added, least)
        return cls(np.degrees(wanted.slope * added), np.degrees(wanted.from_added(nodes.at_rad + added)) % 360.0)

    @classmethod
    def read(cls, text: str) -> Lut:
        """The table of a file."""
        table = np.array([line.split(",") for line in text.splitlines()[1:]], dtype=np.float64)
        return cls(table[:, 1], table[:, 2])

    def __len__(self) -> int:
        return int(self.shaft_deg.size)

    def corrected(self, reading_rad: Array) -> Array:
        """Straight lines from row to row, and from the last to the first."""
        count = len(self)
        place = np.mod(np.asarray(reading_rad), TAU) / TAU * count
        left = np.minimum(place.astype(np.int64), count - 1)
        rise = wrap(radians(np.roll(self.shaft_deg, -1) - self.shaft_deg))
        return np.asarray(radians(self.shaft_deg[left]) + rise[left] * (place - left))

    def text(self, about: Sequence[str], name: str) -> str:
        """CSV, which knows no comments."""
        reading = 360.0 * np.arange(len(self)) / len(self)
        lines = [
            f"{row[0]:.6f},{row[1]:.6f},{row[2]:.6f}"
            for row in zip(reading, self.correction_deg, self.shaft_deg, strict=True)
        ]
        return "\n".join([_HEAD, *lines, ""])


TARGET = Target(
    name="lut",
    what="a plain table as CSV (lut:N for N rows)",
    ending=".csv",
    axis="row k at k/n of a turn of the sensor's own reading",
    sign="linear in between, the last row to the first; shaft_deg holds correction_deg and the zero already",
    unit="deg",
    entries=64,
    absolute=True,
    fitted=Lut.fitted,
    read=Lut.read,
    formula="shaft angle = {reading} + correction_deg {zero} deg",
    load="draw straight lines between its rows: of shaft_deg, the shaft angle as the reference counts it (without one "
    "from a zero of its own), or of correction_deg for the formula",
)
