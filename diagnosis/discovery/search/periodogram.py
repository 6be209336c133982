"""Which lines to look at: one spectrum of the weighted residual instead of a grid of columns."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.discovery.fitting.joint_fit import Fit
from twin.angles import TAU, Array
from twin.effect import Effect, Line

OVERSAMPLING = 4
PEAKS = 8
_FEW = 64
"""So few independent frequencies are all tried; a transform pays for more."""
_LARGEST_GRID = 1 << 21
_BINS_A_READING = 1024
"""A clock that runs evenly takes four bins a reading, one with pauses more: a hundred readings over a year no more than
this, so that they take no longer than a day's."""


def line_shapes(
    matched: Sequence[Array], fit: Fit, effect: Effect, *, peaks: int = PEAKS
) -> tuple[Sequence[Mapping[str, float]], float]:
    """The orders or frequencies at which the effect's line matches the residual best, and how many were looked at.

    ``matched`` holds residuals (n,) filtered by the inverse covariance of the noises in question. ``peaks`` of each
    spectrum are looked at closely.
    """
    line = effect.line
    assert line is not None
    low, high = line.limits(fit.linear.motion)
    if line.clock == "channels":
        return _weights_of_a_bit(matched[0], fit, effect, peaks=peaks)
    clock = clock_of(fit, line)
    span = float(np.ptp(clock))
    if span <= 0.0 or high <= low:
        return [], 0.0
    if line.clock == "shaft" and span < fit.settings.whole_order_turns:
        # Over one turn only whole orders are told apart; others are what an aperiodic residual looks like.
        grid = _whole(low, high)
        grid = grid[line.within(grid)]
        looks = max(float(grid.size), 1.0)
    elif (high - low) * span < _FEW:
        # Few enough to try them all, at a quarter of the resolution.
        grid = np.linspace(low, high, int(np.ceil((high - low) * span * OVERSAMPLING)) + 2)
        # Whole ones that lie closer together than these add nothing, and may be as many as a fast clock has hertz.
        if span * OVERSAMPLING >= 1.0:
            grid = np.unique(np.concatenate([grid, _whole(low, high)]))
        grid = grid[line.within(grid)]
        looks = max(float((high - low) * span), 1.0)
    else:
        spectra = _spectra(matched, fit, effect, clock)
        grid, looks = spectra.whole_orders(line, peaks) if spectra.whole_only(line) else spectra.peaks(line, peaks)
    return [line.begun(float(f)) for f in grid], looks


def _whole(low: float, high: float) -> Array:
    """The whole numbers from low to high."""
    return np.arange(np.ceil(low), np.floor(high) + 1)


def clock_of(fit: Fit, line: Line) -> Array:
    """What the line is periodic in (n,): turns of the shaft, or seconds from the middle of the record."""
    motion = fit.linear.motion
    if line.clock == "shaft":
        return np.asarray(motion.shaft_rad / TAU)
    return np.asarray(motion.time_s - 0.5 * (motion.time_s[0] + motion.time_s[-1]))


@dataclass(frozen=True, eq=False)
class _Spectra:
    """Powers (k, bins) of the matched residuals over frequencies (bins,), between the lowest and highest of the line.

    Each residual gives two: its power, and its power over the noise about it.
    """

    frequency: Array
    powers: Array
    limits: tuple[float, float]
    span: float

    def whole_only(self, line: Line) -> bool:
        """Whether only whole orders belong to the effect."""
        low, high = self.limits
        between = np.array([low + 0.37 / self.span, np.floor(0.5 * (low + high)) + 0.5])
        return not bool(np.any(line.within(between)))

    def whole_orders(self, line: Line, count: int) -> tuple[Array, float]:
        """The best whole orders of each power, and how many there are."""
        low, high = self.limits
        whole = _whole(low, high)
        whole = whole[line.within(whole)]
        ranked = [np.argsort(np.interp(whole, self.frequency, power))[::-1][:count] for power in self.powers]
        return whole[np.unique(np.concatenate(ranked))], float(whole.size)

    def peaks(self, line: Line, count: int) -> tuple[Array, float]:
        """The best local maxima of each power, and how many independent frequencies there are."""
        low, high = self.limits
        inside = (self.frequency >= low) & (self.frequency <= high)
        picked = []
        for power in self.powers:
            power = np.where(inside, power, 0.0)
            peak = np.flatnonzero((power[1:-1] >= power[:-2]) & (power[1:-1] > power[2:])) + 1
            peak = peak[line.within(self.frequency[peak])]
            picked.append(self.frequency[peak[np.argsort(power[peak])[::-1][:count]]])
        chosen = np.unique(np.concatenate(picked))
        # A line at a whole order that belongs to the effect is tried as such.
        whole = np.round(chosen)
        whole = whole[(np.abs(whole - chosen) < 0.5 / self.span) & line.within(whole)]
        looks = max(float(np.count_nonzero(inside)) / OVERSAMPLING, 1.0)
        return np.unique(np.concatenate([chosen, whole])), looks


def _spectra(matched: Sequence[Array], fit: Fit, effect: Effect, clock: Array) -> _Spectra:
    """The match of the effect's line with each residual (n,) over all frequencies.

    The effect's column at frequency f is Re[A exp(i 2 pi f clock)] with an amplitude A (n,) that does not depend on f,
    so one transform serves all f.
    """
    line = effect.line
    assert line is not None
    low, high = line.limits(fit.linear.motion)
    span = float(np.ptp(clock))
    middle = 0.5 * (low + high)
    quadrature = fit.linear.columns(effect, [{line.param: middle}])[0][:, 0]
    turning = np.exp(-1j * TAU * middle * clock)
    amplitudes = [(quadrature[k] - 1j * quadrature[k + 1]) * turning for k in range(0, len(quadrature) - 1, 2)]
    bins = 1 << int(np.ceil(np.log2(max(OVERSAMPLING * 2.0 * high * span, 64.0))))
    bins = min(bins, _LARGEST_GRID, 1 << (_BINS_A_READING * clock.size - 1).bit_length())
    period = OVERSAMPLING * span
    place = (clock - clock.min()) / period * bins
    powers = []
    for weighted in matched:
        transforms = [np.fft.fft(_gridded(weighted * np.conj(a), place, bins))[: bins // 2] for a in amplitudes]
        # Linear interpolation between bins damps high frequencies by sinc^2: undone.
        power = sum((np.abs(one) ** 2 for one in transforms), np.zeros(bins // 2))
        power = power / np.sinc(np.arange(bins // 2) / bins) ** 4
        # A line stands out of the noise about it, whatever the noise's colour; a strong one over gappy clocks has
        # side lobes that raise the level about it, and stands out of everything.
        powers += [power, power / _level(power, OVERSAMPLING)]
    return _Spectra(np.arange(bins // 2) / period, np.stack(powers), (low, high), span)


def _gridded(signal: NDArray[np.complex128], place: Array, bins: int) -> NDArray[np.complex128]:
    """A complex signal (n,) at places (n,) shared out between the two nearest of so many bins."""
    left = np.floor(place).astype(np.int64)
    share = place - left
    grid = np.zeros(bins, dtype=np.complex128)
    for index, part in ((left, 1.0 - share), (left + 1, share)):
        grid += np.bincount(index % bins, (signal * part).real, bins)
        grid += 1j * np.bincount(index % bins, (signal * part).imag, bins)
    return grid


def _level(power: Array, oversampling: int) -> Array:
    """Level of the noise (n,) around each bin: the median over the neighbourhood, wider at higher frequencies."""
    edges = np.unique(np.concatenate([[0], np.geomspace(8 * oversampling, max(power.size, 16), 24)]).astype(int))
    edges = np.unique(np.clip(edges, 0, power.size))
    centres, levels = [], []
    for first, last in itertools.pairwise(edges):
        centres.append(0.5 * (first + last))
        levels.append(max(float(np.median(power[first:last])), 1e-300))
    return np.asarray(np.exp(np.interp(np.arange(power.size), centres, np.log(levels))))


def _weights_of_a_bit(
    weighted: Array, fit: Fit, effect: Effect, *, peaks: int
) -> tuple[Sequence[Mapping[str, float]], float]:
    """Weights [%] at which a wave in the channels' value matches the residual (n,) best, in each of its forms.

    Its fundamental has a period of two steps: one transform over the value serves all weights, its phase the forms.
    """
    assert effect.line is not None
    low, high = effect.line.limits(fit.linear.motion)
    point = fit.linear.at(effect)
    reach = 1.02 * float(np.max(np.abs(point.signal)))
    highest = 100.0 / (2.0 * low)
    bins = min(1 << int(np.ceil(np.log2(OVERSAMPLING * 2.0 * reach * 2.0 * highest))), _LARGEST_GRID)
    period = OVERSAMPLING * 2.0 * reach
    grid = np.zeros(bins)
    for channel in range(2):
        place = point.signal[channel] / period * bins
        left = np.floor(place).astype(np.int64)
        signal = weighted * point.sensitivity[0, channel]
        grid += np.bincount(left % bins, signal * (1.0 - (place - left)), bins)
        grid += np.bincount((left + 1) % bins, signal * (place - left), bins)
    frequency = np.arange(bins // 2) / period
    inside = (frequency > 100.0 / (2.0 * high)) & (frequency < highest)
    match = np.where(inside, np.fft.fft(grid)[: bins // 2], 0.0)
    found: list[Mapping[str, float]] = []
    for phase, form in effect.line.waves:
        size = np.real(phase * np.conj(match))
        peak = np.flatnonzero((size[1:-1] >= size[:-2]) & (size[1:-1] > size[2:]) & (size[1:-1] > 0.0)) + 1
        chosen = peak[np.argsort(size[peak])[::-1][:peaks]]
        found += [{**effect.line.begun(float(50.0 / frequency[k])), **form} for k in chosen]
    looks = max(len(effect.line.waves) * float(np.count_nonzero(inside)) / OVERSAMPLING, 1.0)
    return found, looks
