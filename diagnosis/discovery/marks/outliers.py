"""Outliers: rows that stand far out of their neighbours, and scatter measured blind to them."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.settings import DiscoverySettings
from twin.angles import TAU, Array
from twin.confidence import OF_MAD
from twin.effect import BoolArray
from twin.motion import Motion
from twin.running_median import running_median


def robust_rms(values: Array) -> float:
    """RMS of Gaussian values from their median deviation, blind to outliers."""
    return float(OF_MAD * np.median(np.abs(values - np.median(values)))) if values.size else 0.0


_BOUND = 1.5
"""In units of their RMS: a third of the values may lie anywhere before the estimate does."""
_ROUNDS = 40


def bounded_rms(values: Array) -> float:
    """RMS of Gaussian values of mean zero, none of which counts for more than so many times that.

    P. J. Huber, Ann. Math. Statist. 35 (1964) 73, his second proposal. Of values that have steps, as of rounded
    readings, the median is one of the steps; what is bounded and averaged goes on between them.
    """
    from scipy.stats import norm

    if not values.any():
        return 0.0
    beyond = 2.0 * float(norm.sf(_BOUND))
    within = 1.0 - beyond - 2.0 * _BOUND * float(norm.pdf(_BOUND))
    squares, found = values**2, robust_rms(values) ** 2 or float(np.mean(values**2))
    for _ in range(_ROUNDS):
        before = found
        found = float(np.mean(np.minimum(squares, _BOUND**2 * before))) / (within + _BOUND**2 * beyond)
        if abs(found - before) < 1e-3 * before:
            break
    return float(np.sqrt(found))


LEFT_BY_MEDIAN = 0.866
"""Robust RMS of white noise of RMS 1 once the median of nine neighbours is taken off it (of a million readings)."""


def local_residual(residual: Array) -> Array:
    """Residual (n,) against the median of its neighbours: what single readings do on their own."""
    if residual.size < 12:
        return np.asarray(residual - np.median(residual))
    return residual - running_median(residual)


def local_rms(residual: Array) -> float:
    """RMS of what single readings of a residual (n,) do on their own, blind to outliers and to slow structure.

    Where structure rises or falls by more than the noise from row to row, most rows are the very median of their
    neighbours; the second difference of white noise is then still the root of six times as large as the noise. It is
    counted so that both say the same of white noise.
    """
    return max(robust_rms(local_residual(residual)), LEFT_BY_MEDIAN * rms_of_second_differences(residual))


def rms_of_second_differences(residual: Array) -> float:
    """RMS of white noise in a residual (n,): structure that is smooth from reading to reading has gone from it.

    Mean squares of successive differences: J. von Neumann, Ann. Math. Statist. 12 (1941) 367.
    """
    return robust_rms(np.diff(residual, 2)) / float(np.sqrt(6.0))


def far_out(residual: Array, settings: DiscoverySettings) -> float:
    """How far from its neighbours a row of a residual (n,) stands alone."""
    far = settings.spike_sigma_few if residual.size < settings.spike_few else settings.spike_sigma
    return far * max(local_rms(residual), 1e-9)


def spikes(residual: Array, motion: Motion, step: Array | float, settings: DiscoverySettings) -> BoolArray:
    """Rows (n,) that stand alone, far out of their neighbours.

    Readings on a grid of ``step``, which is in the unit of the residual, for all or each of the rows (n,), jump by a
    whole step where noise moves them by much less. Five or more neighbours off together are structure, not spikes; so
    is what comes again at the same angle.
    """
    away = local_residual(residual)
    mask = np.abs(away) > far_out(residual, settings) + step
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if last - first > settings.longest_spike:
            mask[first:last] = False
    return mask & ~_repeated(away, mask, motion) if mask.any() else mask


def _repeated(away: Array, mask: BoolArray, motion: Motion) -> BoolArray:
    """Which of the marked rows (n,) are off the same way at the same place of other turns, in the same direction.

    Such rows show a narrow shape, or what follows a reversal.
    """
    again = np.zeros_like(mask)
    place = np.round(np.degrees(motion.shaft_rad % TAU) / 2.0).astype(int) % 180
    for way in (1.0, -1.0):
        same_way = motion.direction == way
        for spot in np.unique(place[mask & same_way]):
            here = same_way & np.isin(place, [(spot - 1) % 180, spot, (spot + 1) % 180])
            off = here & mask
            if off.sum() >= 3 and 2 * off.sum() >= here.sum() and abs(np.sum(np.sign(away[off]))) == off.sum():
                again |= off
    return again
