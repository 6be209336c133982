"""What sweeps at several air gaps tell of one sensor: which of its errors follow the field, and which do not.

The field's strength is read from the amplitude of the channels. An error of the electronics keeps its share when the
field changes, a quadratic term grows with the field (q = K1 mag / K2), a constant voltage and a stray field weigh less
the stronger the field is, and a misalignment changes its share in a way of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.error_model.model import BETA, GAIN, QUAD, VX, VY
from twin.angles import Array

_SURE = 4.0
_LAWS = (("stays", 0.0), ("grows with the field", 1.0), ("falls with the field", -1.0))
_PARTS = (("offset", (VX, VY)), ("gain mismatch and phase", (GAIN, BETA)), ("quadratic term", (QUAD,)))
SMALLEST_CHANGE = 0.1
"""Relative change of the amplitude from which sweeps count as different air gaps."""


@dataclass(frozen=True)
class GapSweep:
    """One sweep: fitted point (6,), its covariance (6, 6), amplitude of the channels in a common unit."""

    point: Array
    covariance: Array
    amplitude: float


@dataclass(frozen=True)
class Law:
    """How one factor goes with the field: the law that fits best, and by how many sigma the law "stays" fits worse."""

    part: str
    best: str
    change_sigma: float


def laws(sweeps: Sequence[GapSweep]) -> tuple[Law, ...]:
    """The law that each factor follows, the simplest that fits. Empty where the amplitudes hardly differ."""
    strength = np.array([sweep.amplitude for sweep in sweeps])
    if len(sweeps) < 2 or np.ptp(strength) < SMALLEST_CHANGE * strength.max():
        return ()
    field = strength / strength.mean()
    found = []
    for part, rows in _PARTS:
        misfit = {name: sum(_misfit(sweeps, k, field**power) for k in rows) for name, power in _LAWS}
        best = min(misfit, key=lambda name: misfit[name])
        change = float(np.sqrt(max(misfit["stays"] - misfit[best], 0.0)))
        found.append(Law(part, best if change > _SURE else "stays", change))
    return tuple(found)


def sentences(found: tuple[Law, ...]) -> tuple[str, ...]:
    """The laws in words."""
    said = []
    for law in found:
        if law.part == "gain mismatch and phase":
            if law.best == "stays":
                said.append("air gaps: gain ratio and phase keep their share: the electronics, no misalignment")
            else:
                said.append(f"air gaps: gain ratio and phase change ({law.change_sigma:.0f} sigma): misalignment")
        elif law.part == "offset":
            said.append(
                f"air gaps: the offset {law.best}; a constant voltage and a stray field both fall with the field: "
                "turn the housing in the stray field to part them"
            )
        else:
            said.append(f"air gaps: the quadratic term {law.best}")
    return tuple(said)


def _misfit(sweeps: Sequence[GapSweep], row: int, shape: Array) -> float:
    """Chi-squared of value = constant x shape; a gain counts from 1."""
    value = np.array([sweep.point[row] - (1.0 if row == GAIN else 0.0) for sweep in sweeps])
    weight = 1.0 / np.array([max(sweep.covariance[row, row], 1e-300) for sweep in sweeps])
    size = np.sum(weight * shape * value) / np.sum(weight * shape**2)
    return float(np.sum(weight * (value - size * shape) ** 2))
