"""How well a correction does on readings it never saw: on blocks held out, and at a temperature held out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from diagnosis.thermal.laws import FROM_C
from diagnosis.thermal.recording import Recording
from twin.angles import TAU, Array, IntArray, wrap
from twin.effect import BoolArray

BLOCKS = 10
FOLDS = 5
_DEALT = np.array([0, 1, 2, 3, 4, 2, 0, 3, 4, 1])
"""The fold of each block: of two turns, or one there and back, no fold holds the same angles twice, which were lost."""
_GRID = 720
Shaft = Callable[[Array, Array], Array]
"""From readings [rad] and their temperatures [C] to shaft angles [rad]."""


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

    def among(self, rows: BoolArray) -> BeforeAfter:
        """The same of some of the readings (n,)."""
        return BeforeAfter(self.before_rad[rows], self.after_rad[rows])

    def per_turn(self, turn: Array) -> BeforeAfter:
        """The same with each turn's own zero taken out: for references that find their zero anew at every turn."""
        return BeforeAfter(_without_zeros(self.before_rad, turn), _without_zeros(self.after_rad, turn))


def folds(rows: int) -> Iterator[BoolArray]:
    """Masks (rows,) of the held-out readings: blocks of consecutive rows, several a fold, each row once."""
    count = min(FOLDS, rows // 4)
    block = np.arange(rows) * BLOCKS // rows
    dealt = _DEALT[block] if count == FOLDS else block % max(count, 1)
    for fold in range(count):
        yield dealt == fold


def cross_validated(recording: Recording, level: IntArray, correct: Callable[[Recording], Shaft]) -> BeforeAfter:
    """Calibrate on the readings outside each fold and hold the correction against those inside.

    ``level`` (n,) numbers the temperatures, each of which is cut into blocks of its own.
    """
    return on_held_out(recording, shafts_without(level, lambda rows: correct(recording.part(rows))))


def shafts_without(level: IntArray, correct: Callable[[BoolArray], Shaft]) -> list[tuple[BoolArray, Shaft]]:
    """Of each fold the mask (n,) of its readings, and the correction that ``correct`` makes of all others (n,)."""
    return [(mask, correct(~mask)) for mask in _folds_of_all(level)]


def on_held_out(recording: Recording, shafts: Iterable[tuple[BoolArray, Shaft]]) -> BeforeAfter:
    """Errors of readings, each with the correction that was made without its fold."""
    before, after = np.zeros(len(recording)), np.zeros(len(recording))
    for mask, shaft in shafts:
        one = on(recording.part(mask), shaft)
        before[mask], after[mask] = one.before_rad, one.after_rad
    return BeforeAfter(before, after)


def between(recording: Recording, level: IntArray, correct: Callable[[BoolArray], Shaft]) -> dict[int, BeforeAfter]:
    """By level: calibrate on all other temperatures and hold the correction against this one.

    ``correct`` makes the correction of the readings of a mask (n,). Only levels between others are held out: beyond
    those it has seen a correction stays what it is at their end.
    """
    inner = range(1, int(level.max(initial=0)))
    return {k: on(recording.part(level == k), correct(level != k)) for k in inner}


def on(recording: Recording, shaft: Shaft) -> BeforeAfter:
    """Errors of a finished correction on other readings, each at its own temperature.

    The error before is that of the same correction without its shape: its slope and its zero at 25 C alone.
    """
    grid = TAU * np.arange(_GRID) / _GRID
    corrected = shaft(grid, np.full(_GRID, FROM_C))
    turning = [np.mean(np.exp(1j * (slope * grid - corrected))) for slope in (1.0, -1.0)]
    slope = 1.0 if abs(turning[0]) >= abs(turning[1]) else -1.0
    zero = np.angle(turning[0] if slope > 0 else turning[1])
    return BeforeAfter(
        wrap(slope * recording.measured_rad - zero - recording.reference_rad),
        wrap(shaft(recording.measured_rad, recording.temperature_c) - recording.reference_rad),
    )


def against(reference_rad: Array, measured_rad: Array, shaft: Callable[[Array], Array]) -> BeforeAfter:
    """Errors on other readings (n,) of a finished correction that knows no temperature."""
    readings = Recording.at_one_temperature(reference_rad, measured_rad, FROM_C)
    return on(readings, lambda measured, _: shaft(measured))


def _folds_of_all(level: IntArray) -> Iterator[BoolArray]:
    """Masks (n,) of the held-out readings: of each level a fold, and not the same, so that no angle is lost to all."""
    parts = []
    for k in range(int(level.max(initial=0)) + 1):
        rows = np.flatnonzero(level == k)
        parts.append([rows[mask] for mask in folds(rows.size)])
    for number in range(min(FOLDS, level.size // 4)):
        held = np.zeros(level.size, dtype=np.bool_)
        for k, part in enumerate(parts):
            if number < len(part):
                held[part[(number + k) % len(part)]] = True
        if held.any():
            yield held


def _without_zeros(error: Array, turn: Array) -> Array:
    out = error.copy()
    for value in np.unique(turn):
        rows = turn == value
        out[rows] = wrap(out[rows] - np.angle(np.mean(np.exp(1j * out[rows]))))
    return out


def _rms_deg(error: Array) -> float:
    return float(np.degrees(np.sqrt(np.mean(error**2))))
