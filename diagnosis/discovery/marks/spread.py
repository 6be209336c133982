"""Spread: whether the noise is louder at some angles or speeds, or in one stretch of the record, and by how much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.discovery.fitting.coefficients import to_rows
from diagnosis.discovery.fitting.joint_fit import Fit, root_weights
from diagnosis.discovery.fitting.noise.rounding import stairs_rule
from diagnosis.discovery.fitting.observations import Observations
from diagnosis.discovery.marks.two_variances import TwoVariances
from twin.angles import Array
from twin.effect import BoolArray, Effect
from twin.empirical.spread import UNNAMED_BURST
from twin.found_by import added_variance

_FARTHEST = 36.0
"""Squares, in variances, beyond which a reading counts as one at six sigma: what is no noise does not tell its size."""


@dataclass(frozen=True, eq=False)
class SpreadFinding:
    """A shape of the noise's variance over the rows: effect, parameters, twice the gain in log likelihood."""

    name: str
    values: dict[str, float]
    gain: float
    log_p: float
    variance: Array
    intervals: dict[str, tuple[float, float]]


def white_rows(fit: Fit) -> Array:
    """Residual (n,) over the rows, whitened, in units of its own RMS; masked rows are zero.

    What the rows' scale has taken out of them is put back: this is what the spread is judged on.
    """
    rows = _whitened(fit, fit.cosine_residual[0])
    sigma = float(np.sqrt(np.mean(rows[fit.observations.usable] ** 2)))
    return np.where(fit.observations.usable, rows / max(sigma, 1e-300), 0.0)


def _whitened(fit: Fit, coefficients: Array) -> Array:
    """Cosine coefficients (..., n) [rad] of angles over the rows, whitened, each as loud as in its recording."""
    root = root_weights(fit.weighting, fit.observations.observables)[0]
    loud = fit.observations.scale / fit.observations.level
    return np.asarray(to_rows(fit.observations, coefficients * root) * loud)


def squares(fit: Fit) -> Array:
    """Squares [rad^2] of the whitened rows in use, with what the fit has taken out of each of them.

    Of uneven rows it follows the quiet ones, which it takes more of.
    """
    covariance = fit.covariance()
    slopes = _whitened(fit, fit.cosine_jacobian[:, 0])
    taken = np.sum(slopes * (np.where(np.isfinite(covariance), covariance, 0.0) @ slopes), axis=0)
    left = _whitened(fit, fit.cosine_residual[0]) ** 2
    # Of parameters that nothing tells apart, as on a square wave, rounding leaves variances below zero.
    taken = np.maximum(taken, 0.0)
    return np.asarray((left + taken)[fit.observations.usable])


def _scatter_tells(fit: Fit) -> bool:
    """Whether what is left of the rows in use is noise whose size can be judged: neither stairs nor a file's digits."""
    left = fit.residual[0][fit.observations.usable]
    smallest_rad = float(np.radians(fit.settings.smallest_rms_deg))
    return left.size > 0 and float(np.mean(left**2)) > smallest_rad**2 and not stairs_rule(fit)


def spread_shapes(fit: Fit, effects: Sequence[Effect]) -> list[SpreadFinding]:
    """Which declared shapes of the variance gain over constant variance, each at its best strength."""
    if not _scatter_tells(fit):
        return []
    square = squares(fit)
    expected = _expected_variance(fit, np.minimum(square, _FARTHEST * np.mean(square)))
    provides = fit.observations.motion.provides
    shown = [effect for effect in effects if effect.spread is not None and effect.visible_in(provides)]
    found = [_spread_shape(fit, effect, square, expected) for effect in shown]
    return [finding for finding in found if finding is not None]


def _spread_shape(fit: Fit, effect: Effect, square: Array, expected: Array) -> SpreadFinding | None:
    """One effect's shape of the variance at its best strength, given the squares (rows in use,); None: no gain."""
    assert effect.spread is not None
    use, angle, motion = fit.observations.usable, fit.linear.sensor_angle, fit.observations.motion
    name = effect.roles("random")[0]
    typical = effect.params[name].typical
    # A row that averages several readings has a share of what each of them has.
    readings = np.bincount(fit.observations.group) * fit.observations.level**2
    every = added_variance(effect.spread, angle, motion, {name: typical}) / readings
    unit = float(np.mean(every[use]))
    if np.ptp(every[use]) <= 1e-3 * unit:
        return None
    shape = every[use] / unit
    near = np.minimum(square, _FARTHEST * expected * np.mean(square))
    gain, ratio = _variance_gain(near, shape, expected)
    if ratio > 0.0:
        # How far out a reading is, its own variance says: where few rows are loud, theirs is far above the mean.
        profile = expected + ratio * shape
        near = np.minimum(square, _FARTHEST * profile * float(np.mean(near / profile)))
        gain, ratio = _variance_gain(near, shape, expected)
    if ratio <= 0.0:
        return None
    both = TwoVariances(near, expected, shape).fitted(ratio)
    tails = _inflation(near / both.variance)
    # Whitening makes what is white already larger, by the mean of its weights, and a reading of it several.
    weights = fit.weighting.family.weights[fit.weighting.member]
    white = float(np.mean(weights))
    inflation = tails * both.inflation(float(np.mean(weights**2)) / white**2)
    low, value, high = (
        typical * float(np.sqrt(part / white / unit)) for part in np.insert(both.interval(inflation), 1, both.added)
    )
    full = every * (value / typical) ** 2 + both.base
    return SpreadFinding(effect.name, {name: value}, gain, _half_chi_square(gain / tails), full, {name: (low, high)})


def _expected_variance(fit: Fit, square: Array) -> Array:
    """Relative variance of the rows in use that the output's stairs alone lead one to expect, mean 1.

    Between two steps of a coarse grid readings scatter more than on a step; how much of that is seen depends on how
    fast the noise ahead of the grid is, so the data choose.
    """
    if fit.linear.stair_variance is None:
        return np.ones(square.size)
    # A difference of two moments, which rounding may leave below zero.
    stairs = np.maximum(fit.linear.stair_variance[fit.observations.usable], 0.0)
    if not np.mean(stairs) > 0.0:
        return np.ones(square.size)
    stairs = stairs / np.mean(stairs)
    profiles = [1.0 - share + share * stairs for share in np.linspace(0.0, 0.95, 12)]
    return min(profiles, key=lambda v: square.size * np.log(np.mean(square / v)) + np.sum(np.log(v)))


def _variance_gain(square: Array, shape: Array, expected: Array) -> tuple[float, float]:
    """Twice the gain of variance ``expected + ratio shape`` over ``expected`` for squares (n,), and the best ratio."""
    n = square.size
    flat = n * np.log(np.mean(square / expected)) + np.sum(np.log(expected))
    ratios = np.concatenate([[0.0], np.geomspace(0.02, 200.0, 160)])
    gains = np.empty(ratios.size)
    for place, ratio in enumerate(ratios):
        profile = expected + ratio * shape
        gains[place] = flat - (n * np.log(np.mean(square / profile)) + np.sum(np.log(profile)))
    best = int(np.argmax(gains))
    return float(gains[best]), float(ratios[best])


def _inflation(square: Array) -> float:
    """By how much likelihood ratios of a variance are too large, from squares (n,) over their expected variance.

    A square of Gaussian noise has the variance 2 (in units of its mean squared), one of noise with heavier tails has
    more, and the ratio's chi-square is stretched by as much: Box, Biometrika 40 (1953) 318, with the kurtosis of the
    noise itself, its uneven variance taken out. Lighter tails than Gaussian are not credited.
    """
    return max(float(np.var(square / np.mean(square))) / 2.0, 1.0)


def _half_chi_square(gain: float) -> float:
    """Log probability of the gain at the edge of the parameter's range: half a chi-square of one degree."""
    from scipy.special import log_ndtr

    return float(log_ndtr(-np.sqrt(max(gain, 0.0))))


def bursts(fit: Fit, *, against_neighbours: bool = False) -> SpreadFinding | None:
    """The stretch of rows with the most outstanding variance, if its noise is clearly louder than that of the rest.

    ``against_neighbours`` judges each row by how far it is off the mean of the two beside it. Where the search is still
    to come, what a slip or a seam leaves on one side of it is as far off as loud noise is, but off together.
    """
    if not _scatter_tells(fit):
        return None
    use = fit.observations.usable
    rows = _against_neighbours(white_rows(fit), use) if against_neighbours else white_rows(fit)
    stretch = _loudest_stretch(np.where(use, np.minimum(rows**2, _FARTHEST), 0.0), use)
    if stretch is None or stretch.ratio < fit.settings.burst_ratio:
        return None
    sigma = float(np.sqrt(np.mean(fit.residual[0][use] ** 2)))
    row = np.arange(use.size)
    share = np.where((row >= stretch.first) & (row <= stretch.last), stretch.ratio, 1.0)
    base = sigma / np.sqrt(np.mean(share[use]))
    values = {
        "first_row": float(stretch.first),
        "last_row": float(stretch.last),
        "rms_deg": float(np.degrees(base * np.sqrt(stretch.ratio - 1.0))),
    }
    inflation = _inflation(np.minimum(rows[use] ** 2, _FARTHEST) / share[use])
    if against_neighbours:
        inflation *= _OVERLAP
    log_p = _half_chi_square(stretch.gain / inflation) + float(np.log(max(stretch.looks, 1)))
    return SpreadFinding(UNNAMED_BURST.name, values, stretch.gain, log_p, base**2 * share, {})


_OVERLAP = 1.0 + 2.0 * ((2.0 / 3.0) ** 2 + (1.0 / 6.0) ** 2)
"""By how much more the mean of squared differences from neighbours scatters than that of as many independent squares:
1, and twice the squared correlations of what are one and two rows apart, -2/3 and 1/6 for white noise."""


def _against_neighbours(rows: Array, use: BoolArray) -> Array:
    """Rows (n,) less the mean of the rows in use beside each, as large for white noise as they are; ends have one."""
    place = np.flatnonzero(use)
    if place.size < 3:
        return rows
    used = rows[place]
    left, right = np.concatenate([used[1:2], used[:-1]]), np.concatenate([used[1:], used[-2:-1]])
    off = np.sqrt(2.0 / 3.0) * (used - 0.5 * (left + right))
    # A difference from one neighbour alone has twice the variance of a row, not one and a half times.
    off[[0, -1]] *= np.sqrt(3.0 / 4.0)
    found = np.zeros(rows.size)
    found[place] = off
    return found


@dataclass(frozen=True)
class _Stretch:
    """Rows from ``first`` to ``last``: twice the gain in log likelihood by a variance of their own, its ratio to the
    variance of the rest, and how many independent stretches were looked at."""

    gain: float
    first: int
    last: int
    ratio: float
    looks: int


def _loudest_stretch(square: Array, use: BoolArray) -> _Stretch | None:
    """The stretch that gains most by a larger variance of its own, of squares (n,) that are zero where not in use."""
    n = square.size
    total, count = float(np.sum(square)), int(use.sum())
    sums = np.concatenate([[0.0], np.cumsum(square)])
    counts = np.concatenate([[0], np.cumsum(use)])
    best: _Stretch | None = None
    looks = 0
    length = 10
    while length <= n // 2:
        starts = np.arange(0, n - length + 1, max(length // 6, 1))
        looks += max(n // length, 1) * 2
        inside = sums[starts + length] - sums[starts]
        k = np.maximum(counts[starts + length] - counts[starts], 1)
        outside = np.maximum(total - inside, 1e-12)
        rest = np.maximum(count - k, 1)
        gain = count * np.log(total / count) - k * np.log(np.maximum(inside, 1e-12) / k) - rest * np.log(outside / rest)
        gain = np.where(inside / k > outside / rest, gain, 0.0)
        at = int(np.argmax(gain))
        if best is None or gain[at] > best.gain:
            ratio = float((inside / k)[at] / (outside / rest)[at])
            best = _Stretch(float(gain[at]), int(starts[at]), int(starts[at] + length - 1), ratio, 0)
        length = int(length * 1.3) + 1
    return None if best is None else replace(best, looks=looks)


def row_scale(observations: Observations, variance: Array) -> Array:
    """Noise of each row against the usual one, from a variance (n,)."""
    return np.sqrt(variance / np.median(variance)) if variance.size == len(observations) else np.ones(len(observations))
