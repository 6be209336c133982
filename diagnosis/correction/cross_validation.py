"""How well a correction does on readings it never saw."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.angles import TAU, Array, wrap

BLOCKS = 10
FOLDS = 5
_GRID = 720


@dataclass(frozen=True, eq=False)
class BeforeAfter:
    """Errors [rad] (n,) before and after the correction; before it only calibration's slope and zero are applied."""

    before_rad: Array
    after_rad: Array

    @property
    def rms_deg(self) -> tuple[float, float]:
        """RMS before and after."""
        return _rms_deg(self.before_rad), _rms_deg(self.after_rad)

    @property
    def peak_deg(self) -> tuple[float, float]:
        """Largest error before and after."""
        before, after = (float(np.degrees(np.max(np.abs(part)))) for part in (self.before_rad, self.after_rad))
        return before, after

    def among(self, rows: NDArray[np.bool_]) -> BeforeAfter:
        """The same of some of the readings (n,)."""
        return BeforeAfter(self.before_rad[rows], self.after_rad[rows])

    def per_turn(self, turn: Array) -> BeforeAfter:
        """The same with each turn's own zero taken out: for references that find their zero anew at every turn."""
        return BeforeAfter(_without_zeros(self.before_rad, turn), _without_zeros(self.after_rad, turn))


def folds(rows: int) -> Iterator[NDArray[np.bool_]]:
    """Masks (rows,) of the held-out readings: blocks of consecutive rows, several a fold, each row once."""
    count = min(FOLDS, rows // 4)
    block = np.arange(rows) * BLOCKS // rows
    for fold in range(count):
        yield block % count == fold


def cross_validated(
    reference_rad: Array, measured_rad: Array, correct: Callable[[Array, Array], Callable[[Array], Array]]
) -> BeforeAfter:
    """Calibrate on the rows outside each fold and hold the correction against those inside.

    ``correct`` takes reference and measured readings and returns a function from readings to shaft angles.
    """
    before, after = np.zeros(reference_rad.size), np.zeros(reference_rad.size)
    for mask in folds(reference_rad.size):
        shaft = correct(reference_rad[~mask], measured_rad[~mask])
        one = against(reference_rad[mask], measured_rad[mask], shaft)
        before[mask], after[mask] = one.before_rad, one.after_rad
    return BeforeAfter(before, after)


def against(reference_rad: Array, measured_rad: Array, shaft: Callable[[Array], Array]) -> BeforeAfter:
    """Errors of a finished correction on other readings (n,).

    The error before is that of the same correction without its shape: its slope and its zero alone.
    """
    grid = TAU * np.arange(_GRID) / _GRID
    corrected = shaft(grid)
    turning = [np.mean(np.exp(1j * (slope * grid - corrected))) for slope in (1.0, -1.0)]
    slope = 1.0 if abs(turning[0]) >= abs(turning[1]) else -1.0
    zero = np.angle(turning[0] if slope > 0 else turning[1])
    return BeforeAfter(wrap(slope * measured_rad - zero - reference_rad), wrap(shaft(measured_rad) - reference_rad))


def _without_zeros(error: Array, turn: Array) -> Array:
    out = error.copy()
    for value in np.unique(turn):
        rows = turn == value
        out[rows] = wrap(out[rows] - np.angle(np.mean(np.exp(1j * out[rows]))))
    return out


def _rms_deg(error: Array) -> float:
    return float(np.degrees(np.sqrt(np.mean(error**2))))
