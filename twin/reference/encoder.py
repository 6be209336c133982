"""Counts of an incremental reference encoder, and the orders at which a drive's ripple is to be expected."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.angles import TAU, Array
from twin.limits import require_within

EDGES = 4
"""Counts a line: both edges of both tracks."""


@dataclass(frozen=True, kw_only=True)
class Encoder:
    """An incremental encoder: ``lines`` a turn, ``interpolation`` of each line, its index at ``index_deg``.

    Without an index it counts from where it was switched on.
    """

    lines: int = 5000
    interpolation: int = 1
    index_deg: float = 0.0
    has_index: bool = True

    def __post_init__(self) -> None:
        require_within("lines", self.lines, 1, 1e6, whole=True)
        require_within("interpolation", self.interpolation, 1, 1e5, whole=True)
        require_within("index_deg", self.index_deg, -360.0, 360.0, "deg")

    @property
    def counts(self) -> int:
        """Counts a turn."""
        return EDGES * self.lines * self.interpolation

    def read(self, shaft_rad: Array) -> Array:
        """Readings [rad] (n,) of the shaft angle (n,): whole counts, from the index or from the first reading."""
        zero = np.radians(self.index_deg) if self.has_index else shaft_rad[0]
        count: NDArray[np.float64] = np.floor((shaft_rad - zero) / TAU * self.counts + 0.5)
        start = np.radians(self.index_deg) if self.has_index else 0.0
        return np.asarray(start + count * (TAU / self.counts))


def stepper_order(steps: int) -> int:
    """Electrical periods a turn of a two-phase stepper: where ``drive_ripple`` of a stepped shaft lies."""
    require_within("steps", steps, 4, 1e5, whole=True)
    return steps // 4


def bldc_order(pole_pairs: int) -> int:
    """Torque ripple of a BLDC motor in six-step commutation: six times a pole pair, cycles a turn."""
    require_within("pole_pairs", pole_pairs, 1, 1000, whole=True)
    return 6 * pole_pairs
