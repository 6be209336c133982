"""Angle words as they were read, what a smooth error leads one to expect of them, and what a fault of the link did."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from twin.angles import TAU, Array, IntArray, within_turn, wrap
from twin.confidence import OF_MAD
from twin.found_by import BoolArray
from twin.least_squares import fitted
from twin.motion import Motion

ORDERS = 2
"""Orders of the error that are expected of any sensor: offset and gain, see the paper's error model."""
FAR_SIGMA = 7.0
"""A word is far from what is expected beyond so many robust standard deviations: never by noise in a million."""
MISSED = 0.04
"""Share of the words that may contradict a fault: others' errors, of a few percent at most."""
LIMIT_LOG_P = float(np.log(0.01 / 20.0))
"""Log probability by chance from which on a fault counts: a hundredth, shared by as many causes as are looked for."""
MOST_FAULTS = 4
"""So many at once: a link with more faults is no link."""
_BINS = 90
NEAR_RAD = np.radians(30.0)
"""No sensor's smooth error is larger."""
_PASSES = 6
_TRIMMED = 5.0
_DIGITS_RAD = tuple(np.radians((1.2e-6, 6e-4, 6e-3, 6e-2)))
"""As many digits as files have: six decimals of a degree, or three, two or one."""
_DECIMALS_OF_A_TURN = 360_000
"""Thousandths of a degree."""
_DECIMAL_RAD = 1e-4
_HALF_A_TENTH = 0.05
"""Of a radian, the coarsest decimal: a reading just below the turn may be rounded to as much beyond it."""
_LONGEST_WORD = 20


@dataclass(frozen=True, eq=False)
class Expected:
    """What a smooth error leads one to expect: the angle (n,) [rad], its robust standard deviation [rad].

    ``chosen`` (n,) [rad] is of each reading's candidates the one nearest to it; ``residual`` (n,) what that is off by.
    ``zero`` [rad] is what the reference's zero reads, ``sense`` in which of the two senses they count together.
    """

    angle: Array
    chosen: Array
    sigma: float
    zero: float
    sense: float

    @property
    def residual(self) -> Array:
        """What the chosen reading is off by (n,) [rad]."""
        return wrap(self.chosen - self.angle)

    def log_likelihood(self, usable: BoolArray) -> float:
        """Of the readings in use."""
        return float(np.sum(self.log_densities(self.residual[usable])))

    def log_densities(self, off: Array) -> Array:
        """Of readings that are off by so much (m,) [rad]: Gaussian, or anywhere on the circle, as gross errors are."""
        anywhere = -np.log(np.sqrt(TAU))
        return np.asarray(np.maximum(-0.5 * (off / self.sigma) ** 2 - np.log(self.sigma), anywhere))


@dataclass(frozen=True, eq=False)
class Words:
    """Readings (n,) [rad] with the reference's (n,) [rad]; ``usable`` masks those that a fault has claimed already.

    ``motion``, where it is known: the conditions of each reading.
    """

    reference: Array
    measured: Array
    usable: BoolArray
    motion: Motion | None = None

    def __len__(self) -> int:
        return int(self.measured.size)

    @cached_property
    def bits(self) -> int | None:
        """Length of the shortest word on whose grid all usable readings lie; None where they lie on none."""
        return word_length(self.measured[self.usable], shortest=5)

    @property
    def step(self) -> float:
        """Step [rad] between words; that of a file's digits where they lie on no grid."""
        return float(np.radians(1e-4)) if self.bits is None else TAU / 2.0**self.bits

    @cached_property
    def numbers(self) -> IntArray:
        """The words (n,) as numbers; of readings on no grid, by a file's digits."""
        return np.round(self.measured / self.step).astype(np.int64) % round(TAU / self.step)

    @cached_property
    def expected(self) -> Expected:
        """What is expected of the readings as they are."""
        return self.of_candidates(self.measured[None])

    @property
    def apart(self) -> float:
        """From how far on [rad] two expected words differ by more than the noise."""
        return FAR_SIGMA * self.expected.sigma + self.step

    def of_candidates(self, candidates: Array) -> Expected:
        """What is expected where each reading may stand for several (c, n) [rad]: NaN where there is none.

        The zero is where most differences to the reference lie close together; orders up to the second are fitted by
        least squares to the candidates nearest to them, without those that are far off.
        """
        sense, zero = _sense_and_zero(self.reference, candidates[:, self.usable], self.usable)
        turn = sense * self.reference + zero
        columns = of_orders(self.reference, ORDERS if self.usable.sum() >= 12 else 1)
        curve, limit = np.zeros(len(self)), float(NEAR_RAD)
        sigma, chosen = limit, candidates[0]
        for _ in range(_PASSES):
            chosen = _nearest(candidates, turn + curve)
            off = wrap(chosen - turn)
            kept = self.usable & (np.abs(wrap(off - curve)) <= limit)
            if kept.sum() <= columns.shape[1]:
                break
            curve = columns @ fitted(columns, off, kept)
            left = np.abs(wrap(off - curve))
            freedom = kept.sum() / (kept.sum() - columns.shape[1])
            sigma = float(OF_MAD * np.median(left[kept]) * np.sqrt(freedom))
            sigma = max(sigma, self.step / np.sqrt(12.0))
            limit = min(float(NEAR_RAD), _TRIMMED * sigma)
        return Expected(wrap(turn + curve), _nearest(candidates, turn + curve), sigma, zero, sense)

    @property
    def follow(self) -> bool:
        """Whether the readings in use go round with the reference at all, but for a few."""
        if not self.usable.any():
            return False
        near = np.abs(self.expected.residual[self.usable]) < NEAR_RAD
        return float(np.mean(near)) >= 1.0 - 2.0 * MISSED

    def without(self, fault: WordFault) -> Words:
        """What is left to be told once a fault is known: its readings decoded, or set aside where they say nothing."""
        return replace(self, measured=fault.decoded, usable=self.usable & ~fault.lost)


@dataclass(frozen=True)
class Alike:
    """Another fault that sends the very same words: ``said`` puts it into words.

    ``zero_rad`` is what it adds to each reading that is told back, and so to what the reference's zero reads.
    """

    said: str
    zero_rad: float


@dataclass(frozen=True, eq=False)
class WordFault:
    """What a fault of the link did to the words of a sweep.

    Attributes
    ----------
    values, intervals : mapping
        Its parameters, and low and high of those that are not known exactly.
    log_p : float
        Log probability that words without it look like this.
    touched, lost : ndarray
        Readings (n,) that it changed, and those of them that say nothing of the angle any more.
    decoded : ndarray
        The readings (n,) [rad] as they would be without it, where that can be told.
    also : tuple
        Parameters of further instances that were told together with the first.
    alike : tuple of Alike
        What sends the very same words.
    """

    values: Mapping[str, float]
    log_p: float
    touched: BoolArray
    lost: BoolArray
    decoded: Array
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    also: tuple[Mapping[str, float], ...] = ()
    alike: tuple[Alike, ...] = ()


class FindInWords(Protocol):
    """Tells an effect's fault by the words themselves, ahead of every fit; None where they show none."""

    def __call__(self, words: Words) -> WordFault | None: ...


@dataclass(frozen=True, kw_only=True)
class Also:
    """Another ``cause`` that does the same ``where`` it says so, by readings (n,) [rad], motion and touched rows.

    ``tells`` is the measurement that would tell them apart.
    """

    cause: str
    tells: str
    where: Callable[[Array, Motion, Sequence[int]], bool]


@dataclass(frozen=True, kw_only=True)
class InWords:
    """How a fault of the link is told by the words themselves.

    ``said`` puts a fault's parameters into words; ``line`` does so with each as it is shown, with its interval and
    unit. ``rows_listed``: whether the answer names each reading that it touched. ``several``: whether there may be more
    of them in one sweep. ``also``: what else does the same.
    """

    find: FindInWords
    said: Callable[[Mapping[str, float]], str]
    line: Callable[[Mapping[str, float], Mapping[str, str]], str] | None = None
    rows_listed: bool = False
    several: bool = False
    also: Also | None = None


def faults_of(words: Words, finders: Mapping[str, InWords], limit_log_p: float) -> tuple[tuple[str, WordFault], ...]:
    """The faults that the words show, each with its name, the least likely by chance first.

    What one fault explains is taken off before the next is asked for; each that is as improbable as ``limit_log_p``
    counts, or more.
    """
    found: list[tuple[str, WordFault]] = []
    left = dict(finders)
    while len(found) < MOST_FAULTS:
        told = [(name, one) for name, way in left.items() if (one := way.find(words)) is not None]
        name, best = min(told, key=lambda one: one[1].log_p, default=("", None))
        if best is None or best.log_p > limit_log_p or not best.touched.any():
            break
        rest = words.without(best)
        if not rest.follow:
            break
        found.append((name, best))
        words = rest
        if not finders[name].several:
            del left[name]
    return tuple(found)


def _nearest(candidates: Array, angle: Array) -> Array:
    """Of each reading's candidates (c, n) [rad] the one nearest to an angle (n,) [rad]."""
    if len(candidates) == 1:
        return np.asarray(candidates[0])
    off = np.where(np.isnan(candidates), np.inf, np.abs(wrap(np.nan_to_num(candidates) - angle)))
    return np.asarray(candidates[np.argmin(off, axis=0), np.arange(candidates.shape[1])])


def word_length(read: Array, *, shortest: int) -> int | None:
    """Length of the shortest word, of those of so many bits and more, on whose grid readings (n,) [rad] lie, if any."""
    for bits in range(shortest, _LONGEST_WORD + 1):
        step = TAU / 2.0**bits
        off = float(np.max(np.abs(read / step - np.round(read / step)), initial=0.0)) * step
        if any(off < digits < step / 12.0 for digits in _DIGITS_RAD):
            return bits
    return None


def decimal_step(read: Array) -> float | None:
    """The step [rad] of few decimals on which readings (n,) [rad] lie, in each turn from its zero; None: of many.

    The coarsest whole number of thousandths of a degree of which a turn has a whole number, or of ten-thousandths of a
    radian. The last of these may lie beyond the turn: 6.2832 is the reading of one that is just below it.
    """
    turned = read if np.all((read >= 0.0) & (read < TAU + _HALF_A_TENTH)) else within_turn(read)
    for decimal, turn in ((TAU / _DECIMALS_OF_A_TURN, _DECIMALS_OF_A_TURN), (_DECIMAL_RAD, 0)):
        places = np.round(turned / decimal)
        if np.max(np.abs(turned - places * decimal), initial=0.0) < _DIGITS_RAD[0]:
            return float(np.gcd.reduce(places.astype(np.int64), initial=turn) * decimal) or None
    return None


def noise_of(left: Array) -> float:
    """RMS of the noise in what is left (n,) in the order of the readings, by its second differences."""
    return float(OF_MAD * np.median(np.abs(np.diff(left, 2)))) / float(np.sqrt(6.0)) if left.size > 2 else 0.0


def of_orders(reference: Array, orders: int) -> Array:
    """Constant, cosines and sines (n, 1 + 2 orders) of the shaft angle."""
    turns = np.multiply.outer(reference, np.arange(1, orders + 1))
    return np.concatenate([np.ones((reference.size, 1)), np.cos(turns), np.sin(turns)], axis=1)


def _sense_and_zero(reference: Array, candidates: Array, usable: BoolArray) -> tuple[float, float]:
    """In which sense and from which zero [rad] most candidates (c, m) lie close to the reference (n,)."""
    best = (-1.0, 1.0, 0.0)
    for sense in (1.0, -1.0):
        away = (candidates - sense * reference[usable]).ravel()
        # Where candidates lie as close together as the readings themselves, it is these that are meant.
        weight = np.repeat(np.where(np.arange(len(candidates)) == 0, 1.0, 0.99), candidates.shape[1])
        known = np.isfinite(away)
        away, weight = np.mod(away[known], TAU), weight[known]
        count = np.bincount((away * (_BINS / TAU)).astype(np.int64) % _BINS, weight, minlength=_BINS)
        near = np.sum([np.roll(count, shift) for shift in range(-2, 3)], axis=0)
        place = int(np.argmax(near))
        if near[place] > best[0]:
            centre = (place + 0.5) * TAU / _BINS
            within = wrap(away - centre)
            middle = float(np.median(within[np.abs(within) < 2.5 * TAU / _BINS]))
            best = (float(near[place]), sense, centre + middle)
    return best[1], best[2]
