"""What a correction would gain: one that all devices are given alike, against one of each device's own.

The readings' change with the parameters is known from each device's fit, so that the error left by any parameters is a
quadratic form. A common correction uses the mean of the other devices, as it would for a device to come; one of the
device's own is charged with what its parameters are not known better than. Each device's zero is its own throughout:
it says how it was put on the bench.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.population.batch import ZERO, Batch
from diagnosis.population.pooled import SENSOR
from twin.angles import Array
from twin.baseline import FACTORS
from twin.effect import BoolArray

_LARGEST_SHARE = 0.95
"""Share of the devices that keep what is called the largest error: the few that stand apart are told by name."""


@dataclass(frozen=True, kw_only=True)
class Correction:
    """Error [deg] that a correction leaves: root mean square over the devices, and what 95 % of them keep."""

    name: str
    rms_deg: float
    largest_deg: float


def corrections_of(batch: Batch, usual: BoolArray, phase_from: Sequence[str | None]) -> list[Correction]:
    """No correction, a common one and one for each device, of the factors and of the shared causes beside them.

    ``usual`` (N,) devices tell the mean that the common one is made of; ``phase_from`` says for each of the shared
    causes from where its phase is counted, None where no device's tells that of another.
    """
    own = batch.arrays["fitted"]
    null = np.concatenate([[factor.null for factor in FACTORS], np.zeros(own.shape[1] - len(FACTORS))])
    mean = _common(batch, usual, phase_from)
    factors, causes = np.arange(own.shape[1]) < len(FACTORS), np.arange(own.shape[1]) >= len(FACTORS)
    asked = {
        "none": np.broadcast_to(null, own.shape),
        "common factors": np.where(causes, null, mean),
        "common factors and causes": mean,
        "own factors": np.where(factors, own, null),
        "own factors and causes": own,
    }
    if not causes.any():
        asked = {name: values for name, values in asked.items() if "causes" not in name}
    found = []
    for name, values in asked.items():
        squares = _left(batch, values, fitted=np.all(values == own, axis=0) & (not name.startswith("common")))
        found.append(
            Correction(
                name=name,
                rms_deg=float(np.sqrt(np.mean(squares))),
                largest_deg=float(np.sqrt(np.quantile(squares, _LARGEST_SHARE))),
            )
        )
    return found


def _common(batch: Batch, usual: BoolArray, phase_from: Sequence[str | None]) -> Array:
    """Parameters (N, m) that a common correction uses for each device: the mean of the others."""
    common = _mean_of_others(batch.arrays["fitted"], usual)
    start = len(FACTORS)
    for number, (one, where) in enumerate(zip(batch.present, phase_from, strict=True)):
        own = slice(start, start + one.terms)
        start += one.terms
        figures = batch.figures_of_present(number)
        if where == SENSOR and figures.turned is not None:
            mean = _mean_of_others(figures.counted_from(SENSOR), usual)
            # Back to where each device's readings count from.
            turned = (mean[:, 0] + 1j * mean[:, 1]) * np.exp(1j * figures.turned)
            common[:, own] = np.stack([turned.real, turned.imag], axis=1)
    return common


def _mean_of_others(values: Array, usual: BoolArray) -> Array:
    """Mean (N, m) of the figures (N, m) over the usual devices without the one in question."""
    count = np.count_nonzero(usual) - usual
    total = values[usual].sum(axis=0) - np.where(usual[:, None], values, 0.0)
    return np.asarray(total / np.maximum(count, 1)[:, None])


def _left(batch: Batch, values: Array, *, fitted: BoolArray) -> Array:
    """Mean square error [deg^2] (N,) of each device, its readings to come corrected by parameters (N, m).

    ``fitted`` (m,) are those of the device's own fit: each costs the variance of a reading over their number.
    """
    own, curvature = batch.arrays["fitted"], batch.arrays["curvature"]
    off = values - own
    rest = np.arange(own.shape[1]) != ZERO
    # The zero is set again for every correction: what the others do along it costs nothing.
    pulled = curvature[:, rest, ZERO] / curvature[:, ZERO, ZERO][:, None]
    about = curvature[:, rest][:, :, rest] - pulled[:, :, None] * curvature[:, ZERO, rest][:, None, :]
    squares = np.einsum("ni,nij,nj->n", off[:, rest], about, off[:, rest])
    noise = batch.arrays["own_rms_deg"] ** 2
    paid = 1.0 + np.count_nonzero(fitted) / np.maximum(batch.arrays["rows"], 1.0)
    return np.asarray(np.maximum(squares, 0.0) + noise * paid)
