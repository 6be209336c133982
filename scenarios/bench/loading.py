"""A correction on its way into the encoder: a list of numbers, one a frame, active when the last one is in."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from diagnosis.correction.compensation import MOST_ORDERS, Correction

NONE, RECEIVING, ACTIVE, REFUSED = 0, 1, 2, 3
"""CorrectionStatus.State."""
_FIXED = 2


def numbers(correction: Correction | None) -> list[float]:
    """Slope, zero [rad], then cosine and sine [rad] of each order; none for no correction."""
    if correction is None:
        return []
    return [float(correction.slope), correction.zero_rad, *map(float, correction.series.T.ravel())]


def items(values: list[float]) -> list[float]:
    """The items to send: how many numbers, the numbers, the word that makes them active."""
    return [float(len(values)), *values, 0.0]


@dataclass(eq=False)
class Loader:
    """The encoder's side. What is active stays so until a whole and sensible list has arrived."""

    active: Correction | None = None
    _transfer: int | None = None
    _expected: int = 0
    _values: dict[int, float] = field(default_factory=dict)
    _finished: bool = False

    def take(self, transfer: int, item: int, value: float) -> int:
        """Take an item, in any order and any number of times; returns the state to report."""
        if item == 0:
            # A number comes round again: what follows a finished list is a new one.
            if transfer != self._transfer or self._finished:
                self._transfer, self._values, self._finished = transfer, {}, False
            self._expected = int(value) if 0.0 <= value <= _FIXED + 2 * MOST_ORDERS else -1
            return RECEIVING if self._expected >= 0 else REFUSED
        if transfer != self._transfer or self._expected < 0 or item > self._expected + 1:
            return REFUSED
        if item <= self._expected:
            self._values[item] = value
            return RECEIVING
        if not self._finished:
            self._finished = self._activate()
        return ACTIVE if self._finished else REFUSED

    def _activate(self) -> bool:
        if self._expected == 0:
            self.active = None
            return True
        values = [self._values.get(item, np.nan) for item in range(1, self._expected + 1)]
        whole = len(values) >= _FIXED and len(values) % 2 == 0 and np.isfinite(values).all()
        if not whole or values[0] not in (1.0, -1.0):
            return False
        series = np.array(values[_FIXED:], dtype=np.float64).reshape(-1, 2).T
        self.active = Correction(int(values[0]), values[1], np.ascontiguousarray(series), (), 0.0)
        return True
