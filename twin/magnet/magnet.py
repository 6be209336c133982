"""Magnet: the body on the shaft. Its numbers may be arrays of shape (designs,), one entry a design."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from twin.angles import Array
from twin.known_names import nearest
from twin.limits import OutOfRangeError, require_within
from twin.magnet.materials import REFERENCE_C, grade
from twin.shown import shown

Shape = Literal["cylinder", "ring", "block"]
Number = float | Array

LARGEST_MM = 200.0
SMALLEST_MM = 0.1
LARGEST_T = 2.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Magnet:
    """A uniformly magnetised body, centred on its own axis, magnetised across it (diametrally).

    ``diameter_mm`` is the outer diameter; ``bore_mm`` the inner one of a ring. A block is ``length_mm`` long in the
    direction of its magnetisation and ``width_mm`` across. ``height_mm`` counts along the axis. A remanence given
    here overrides that of the grade; the temperature coefficient is the grade's unless given.
    """

    shape: Shape = "cylinder"
    diameter_mm: Number = 6.0
    height_mm: Number = 2.5
    bore_mm: Number = 2.0
    length_mm: Number = 6.0
    width_mm: Number = 6.0
    grade: str = "N35H"
    remanence_T: Number | None = None
    percent_per_K: Number | None = None

    def __post_init__(self) -> None:
        if self.shape not in get_args(Shape):
            shapes = get_args(Shape)
            raise OutOfRangeError(
                f"shape is {shown(self.shape)}{nearest(self.shape, shapes)}; expected one of {', '.join(shapes)}"
            )
        grade(self.grade)
        # Those of another shape too: they are read, handed on and written.
        for name in ("height_mm", "diameter_mm", "length_mm", "width_mm"):
            require_within(name, getattr(self, name), SMALLEST_MM, LARGEST_MM, "mm")
        widest = 0.95 * float(np.min(self.diameter_mm)) if self.shape == "ring" else LARGEST_MM
        require_within("bore_mm", self.bore_mm, 0.0, widest, "mm")
        if self.remanence_T is not None:
            require_within("remanence_T", self.remanence_T, 1e-3, LARGEST_T, "T")
        if self.percent_per_K is not None:
            require_within("percent_per_K", self.percent_per_K, -1.0, 1.0, "%/K")

    @property
    def reach_mm(self) -> Array:
        """Radius of the circle about the axis that holds the body [mm]."""
        if self.shape == "block":
            return np.asarray(0.5 * np.hypot(self.length_mm, self.width_mm))
        return np.asarray(0.5 * np.asarray(self.diameter_mm, dtype=np.float64))

    def remanence_at(self, temperature_c: Number = REFERENCE_C) -> Array:
        """Remanence [T] at this temperature [C]: linear in the temperature, from the value at 20 C.

        Raises OutOfRangeError where the line has fallen to zero: no magnet turns its poles round for that.
        """
        stated = grade(self.grade)
        base = stated.remanence_T if self.remanence_T is None else self.remanence_T
        slope = stated.percent_per_K if self.percent_per_K is None else self.percent_per_K
        found = np.asarray(base * (1.0 + 0.01 * np.asarray(slope) * (np.asarray(temperature_c) - REFERENCE_C)))
        if np.any(found <= 0.0):
            hottest = float(np.max(temperature_c))
            raise OutOfRangeError(
                f"remanence is {np.min(found):g} T at {hottest:g} C; expected more than 0: a smaller percent_per_K, or "
                "other temperatures"
            )
        return found
