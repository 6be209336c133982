"""What a report draws: error and residuals of every reading, their spectra, and each cause's own share."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.linearised_chain import Linear
from diagnosis.discovery.marks.row_masks import raw_residual
from diagnosis.discovery.result import Discovery
from diagnosis.report.facts import angle_error_deg
from diagnosis.report.fitted_rows import fitted
from twin.angles import TAU, Array, wrap
from twin.effect import BoolArray
from twin.motion import Motion

HIGHEST_ORDER = 1024
"""Spectra end here, however dense the readings."""
_MOST_BINS = float(1 << 21)


@dataclass(frozen=True, eq=False)
class Readings:
    """Every used reading of a sweep, arrays (n,): where it was taken, its error, and what the twins leave of it [deg].

    ``predicted_deg`` is the error as the baseline predicts it; ``plain`` marks readings that the fits were made
    of.
    """

    motion: Motion
    angle_deg: Array
    error_deg: Array
    predicted_deg: Array
    before_deg: Array
    after_deg: Array
    plain: BoolArray

    @property
    def clock(self) -> tuple[Array, str]:
        """What the readings follow each other by: time where it was recorded, else their number; and its name."""
        if "time_s" in self.motion.columns:
            return self.motion.time_s - self.motion.time_s[0], "time / s"
        return np.arange(1.0, len(self.motion) + 1.0), "reading number"

    @property
    def extended(self) -> bool:
        """Whether the extended twin leaves anything else than the baseline, beyond rounding."""
        apart = float(np.max(np.abs(self.after_deg - self.before_deg)))
        return apart > 1e-6 * float(np.max(np.abs(self.before_deg)))


def readings(found: Discovery) -> Readings:
    """The readings of a sweep with what the baseline and the extended twin leave of them."""
    before = np.degrees(raw_residual(found.baseline, found.sweep))
    error, plain = angle_error_deg(found.baseline, found.sweep), fitted(found)
    error = error - np.mean(error[plain])
    return Readings(
        motion=found.sweep.motion(),
        angle_deg=np.mod(found.sweep.reference_deg, 360.0),
        error_deg=error,
        predicted_deg=error - before,
        before_deg=before,
        after_deg=np.degrees(raw_residual(found.fit, found.sweep)),
        plain=plain,
    )


def share_deg(found: Discovery, keys: Sequence[str]) -> Array:
    """What these effects do to each reading [deg] (n,): the extended chain with them minus without them."""
    fit = found.fit
    without = Linear(fit.chain.without(*keys), fit.observations.motion, blur=fit.weighting.blur, observables=1)
    share = np.degrees(wrap(fit.linear.angle - without.angle))
    return share if len(share) == len(found.sweep) else np.asarray(share[fit.observations.group])


def spectrum(motion: Motion, values: Array, use: BoolArray, highest: float) -> tuple[Array, Array]:
    """Orders (cycles a turn) up to ``highest`` and the amplitude of the values (n,) at each.

    What turns with the direction would cancel in a sweep there and back, so it is transformed on its own and added in
    power; half of the step between the directions then stands at order 0. Readings are shared out
    over many bins around the travelled turns, so that one transform serves a million.
    """
    turns = motion.shaft_rad[use] / TAU
    period = max(int(np.ceil(np.ptp(turns) - 1e-3)), 1)
    # Bins must be narrow against the readings' own spacing, whose multiples would fold back as lines.
    per_turn = 1 << int(np.ceil(np.log2(max(8.0 * highest, min(64.0 * highest, _MOST_BINS / period)))))
    bins = per_turn * period
    place = (turns - turns.min()) * per_turn
    left = np.floor(place).astype(np.int64)
    right_share = place - left

    def power_of(signal: Array) -> Array:
        grid = np.bincount(left % bins, signal * (1.0 - right_share), bins)
        grid += np.bincount((left + 1) % bins, signal * right_share, bins)
        return np.asarray(np.abs(np.fft.rfft(grid)) ** 2)

    kept = values[use] - np.mean(values[use])
    power = power_of(kept)
    both = two_ways(motion)
    if both:
        power += power_of(kept * motion.direction[use])
    power[0] /= 4.0
    orders = np.arange(power.size) / period
    inside = (orders >= (0.0 if both else 0.5 / period)) & (orders <= highest)
    return orders[inside], 2.0 * np.sqrt(power[inside]) / kept.size


def two_ways(motion: Motion) -> bool:
    """Whether the shaft turned in both directions."""
    return "both directions" in motion.provides


def noise_level(orders: Array, amplitudes: Array, *, both: bool) -> Array:
    """Amplitude (n,) that noise alone passes at one order in twenty: from the median over each order's neighbours.

    The power of noise is distributed as chi square, with four degrees of freedom where it is summed over both ways.
    """
    ratio = np.sqrt(9.488 / 3.357) if both else np.sqrt(5.991 / 1.386)
    if orders.size < 8:
        return np.full(orders.size, ratio * np.median(amplitudes))
    edges = np.unique(np.linspace(0, orders.size, min(max(orders.size // 12, 2), 24) + 1).astype(int))
    middles = [float(np.mean(orders[a:b])) for a, b in itertools.pairwise(edges)]
    medians = [float(np.median(amplitudes[a:b])) for a, b in itertools.pairwise(edges)]
    return np.asarray(ratio * np.interp(orders, middles, medians))


def highest_order(motion: Motion, orders: Sequence[float]) -> float:
    """Half the readings a turn, further where a line was found beyond."""
    return float(min(max(0.5 * motion.points_per_turn, 10.0, *(1.1 * order for order in orders)), HIGHEST_ORDER))


def binned(x: Array, y: Array, bins: int, limits: tuple[float, float] = (0.0, 360.0)) -> tuple[Array, Array]:
    """Means of y over bins of x: the bins' mean x and y, NaN where a bin is empty."""
    low, high = limits
    place = np.clip(((x - low) / (high - low) * bins).astype(np.int64), 0, bins - 1)
    count = np.bincount(place, minlength=bins).astype(np.float64)
    count[count == 0.0] = np.nan
    return np.bincount(place, x, bins) / count, np.bincount(place, y, bins) / count


def unexplained_by(x: Array, y: Array, bins: int = 72) -> float:
    """Share of the variance of y (n,) that remains within bins of x over a turn [deg]."""
    place = np.clip((x / 360.0 * bins).astype(np.int64), 0, bins - 1)
    count = np.maximum(np.bincount(place, minlength=bins), 1)
    mean = np.bincount(place, y, bins) / count
    total = float(np.var(y))
    return float(np.mean((y - mean[place]) ** 2)) / total if total > 0.0 else 0.0
