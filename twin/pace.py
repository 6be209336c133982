"""How fast the shaft turned, where no speed was recorded: from the reference's angles over their time stamps."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from twin.angles import Array, IntArray
from twin.running_median import running_median

STOP_AND_MEASURE_S = 0.02
"""Readings farther apart than this, with no speed recorded, were taken at standstill."""
LEAST_SPEEDS = 0.2
"""Difference of two speeds, as a share of the faster, from which on what follows them may show."""
_SELDOM = 0.01
"""Share of the readings at one speed that may be faster, and slower, than that."""

_TOGETHER = (2, 4, 8, 16, 32)
"""Ticks over which the pace is taken where the clock jitters: of two that are off by a step each, 32 keep 6 %."""
_FEWEST = 17
"""Readings of a window, of which three figures of the motion are fitted."""
_FEWEST_WINDOWS, _MOST_WINDOWS = 8, 512
"""Of a stretch: a parabola over more of a coast than an eighth is not the coast."""
_SURE = 3e-4
"""Share of the speed to which its standard error is brought, where the windows allow it: what a speed is then off by
stays below the noise of most sensors, about 0.01 deg, for delays that turn the reading by up to 30 deg."""
_LONG_PAUSE = 5.0
"""Times the usual step: a step that takes longer, in which the shaft has gone no farther, holds a pause."""


@dataclass(frozen=True, eq=False)
class _Ticks:
    """Angles [rad] and times [s] (m,) of the first reading of each stamp, and the tick (n,) that each reading is of."""

    angle: Array
    time: Array
    of_row: IntArray

    @property
    def steps(self) -> tuple[Array, Array]:
        """Turn [rad] and duration [s] (m - 1,) from tick to tick."""
        return np.diff(self.angle), np.diff(self.time)


def speed_over_time(shaft_rad: Array, time_s: Array, direction: Array) -> Array:
    """Signed speed of the shaft at each reading, as its time stamps tell it.

    A stretch ends where the pace changes by more than a fifth at once. Where it stays within a fifth the stretch has
    one speed, the median of its steps, or their mean where stamps jitter. Where it goes on changing, as of a shaft that
    coasts down, it is the slope of a parabola through the readings about each one, as few of them as tell it well.

    Parameters
    ----------
    shaft_rad : ndarray
        Shaft angle [rad], (n,), unwrapped.
    time_s : ndarray
        Time [s] of each reading (n,). Equal stamps are those of a coarse clock; one set back goes on from there.
    direction : ndarray
        +1 or -1, (n,): the sense of the speed.

    Returns
    -------
    ndarray
        Speed [rad/s], (n,); all zero where the readings lie so far apart that the shaft may have stopped at each.
    """
    ticks = _ticks(shaft_rad, time_s)
    if ticks.time.size < 3 or not 0.0 < _spacing_s(shaft_rad, ticks) <= STOP_AND_MEASURE_S:
        return np.zeros(shaft_rad.size)
    ticks = _without_pauses(ticks)
    jitters = _of_stamps(ticks)
    rate = _over_many(ticks) if jitters else _pace(ticks, 1)
    smooth = running_median(rate)
    jump = np.abs(np.diff(smooth)) > LEAST_SPEEDS * np.maximum(np.abs(smooth[1:]), np.abs(smooth[:-1]))
    cuts = [0, *(np.flatnonzero(jump) + 1).tolist(), rate.size]
    speed = np.empty(ticks.time.size)
    for a, b in itertools.pairwise(cuts):
        changing = _changing(ticks.angle[a : b + 1], ticks.time[a : b + 1])
        # The reading at which the pace changes has the one by which it was reached: late, it reads where that led from.
        new = slice(min(a, 1), None)
        if changing is None:
            speed[a : b + 1][new] = _mean_pace(ticks, a, b) if jitters else np.median(rate[a:b])
        else:
            speed[a : b + 1][new] = changing[new]
    return np.asarray(np.abs(speed[ticks.of_row]) * direction)


def _ticks(shaft_rad: Array, time_s: Array) -> _Ticks:
    step = np.diff(time_s)
    forward = step[step > 0.0]
    usual = float(np.median(forward)) if forward.size else 0.0
    time = np.concatenate([[0.0], np.cumsum(np.where(step < 0.0, usual, step))])
    first = np.concatenate([[0], np.flatnonzero(step) + 1])
    of_row = np.cumsum(np.concatenate([[0], (step != 0.0).astype(np.int64)]))
    return _Ticks(shaft_rad[first], time[first], of_row)


def _spacing_s(shaft_rad: Array, ticks: _Ticks) -> float:
    """Time between readings at different angles: those of one stamp lie between it and the next, if the shaft moves."""
    step = float(np.median(ticks.steps[1]))
    moved = np.abs(np.diff(shaft_rad))
    same = np.diff(ticks.of_row) == 0
    if np.mean(same) < 0.5 or np.median(moved[same]) < 0.5 * np.mean(moved):
        return step
    return float(np.ptp(ticks.time)) / (shaft_rad.size - 1)


def _without_pauses(ticks: _Ticks) -> _Ticks:
    """The same as if the shaft had gone on at its pace where it waited between two readings."""
    turn, step = ticks.steps
    pace = running_median(turn / step)
    waited = (step > _LONG_PAUSE * running_median(step)) & (_LONG_PAUSE * np.abs(turn) < np.abs(pace) * step)
    if not waited.any():
        return ticks
    going = np.where(waited, np.abs(turn / np.where(waited, pace, 1.0)), step)
    return _Ticks(ticks.angle, np.concatenate([[0.0], np.cumsum(going)]), ticks.of_row)


def _over_many(ticks: _Ticks) -> Array:
    """Pace [rad/s] (m - 1,) about each step over as few ticks as tell it to a quarter of a fifth."""
    rate = _pace(ticks, 1)
    for many in _TOGETHER:
        if 2 * many > rate.size:
            break
        rate = _evenest(ticks, many)
        if _scatter(_pace(ticks, many)[::many]) < 0.25 * LEAST_SPEEDS:
            break
    return rate


def _mean_pace(ticks: _Ticks, first: int, last: int) -> float:
    return float((ticks.angle[last] - ticks.angle[first]) / (ticks.time[last] - ticks.time[first]))


def _pace(ticks: _Ticks, many: int) -> Array:
    """Pace [rad/s] (m - many,) over that many steps from each tick on."""
    turn, lasted = (values[many:] - values[:-many] for values in (ticks.angle, ticks.time))
    return np.asarray(turn / lasted)


def _evenest(ticks: _Ticks, many: int) -> Array:
    """Pace [rad/s] (m - 1,) over those steps about each one, that one included, in which it is the most even.

    Where the shaft goes over to another speed these lie on one side, and nothing is blurred.
    """
    half = many // 2
    pace, part = _pace(ticks, many), _pace(ticks, half)
    uneven = np.abs(part[half:] - part[:-half])
    # A step is in the windows that begin with it and in those that began up to many - 1 steps before.
    padded = np.pad(uneven, many - 1, constant_values=np.inf)
    best = np.argmin(np.lib.stride_tricks.sliding_window_view(padded, many), axis=-1)
    return np.asarray(pace[np.arange(best.size) + best - (many - 1)])


def _of_stamps(ticks: _Ticks) -> bool:
    """Whether the pace scatters as stamps make it that are early or late, and by more than what counts as a speed.

    Over eight ticks, of which the first and the last stamp alone matter, it then scatters an eighth as much; that of a
    shaft which speeds up and slows down by chance at every step, by the root of an eighth.
    """
    if ticks.time.size < 4 * _TOGETHER[2]:
        return False
    own = _scatter(_pace(ticks, 1))
    return own > 0.25 * LEAST_SPEEDS and _scatter(_pace(ticks, 8)[::8]) < 0.25 * own


def _scatter(pace: Array) -> float:
    """RMS change from one pace (k,) to the next, without the twentieth that may be another speed, of the usual pace."""
    usual = float(np.median(np.abs(pace)))
    change = np.sort(np.abs(np.diff(pace)))[: max(1, pace.size - 1 - pace.size // 20)]
    return float(np.sqrt(np.mean(change**2))) / usual if usual > 0.0 and change.size else 0.0


def _changing(angle: Array, time: Array) -> Array | None:
    """Speed [rad/s] (k,) over a stretch whose pace goes on changing; None where it keeps within a fifth."""
    travel = np.maximum.accumulate(np.abs(angle - angle[0]))
    if angle.size < 4 * _FEWEST or travel[-1] == 0.0:
        return None
    width = float(max(_FEWEST * np.median(np.diff(travel)), travel[-1] / _MOST_WINDOWS))
    best, least = np.zeros(angle.size), np.inf
    while least == np.inf or (least > _SURE and width <= travel[-1] / _FEWEST_WINDOWS):
        middles = np.linspace(0.0, travel[-1], int(4.0 * travel[-1] / width) + 1)
        windows, places = _windows(travel, middles, width), np.interp(middles, travel, time)
        speed, error = np.transpose(
            [_slope(angle[a:b], time[a:b], at) for (a, b), at in zip(windows, places, strict=True)]
        )
        share = float(np.median(error) / np.median(np.abs(speed)))
        if share < least:
            best, least = np.interp(time, places, speed), share
        width *= 2.0
    size = np.abs(best)
    return best if np.ptp(size) > LEAST_SPEEDS * np.max(size) else None


def _windows(travel: Array, middles: Array, width: float) -> list[tuple[int, int]]:
    """First tick and one past the last of those within half a width about each middle, of a fair number at least."""
    half = 0.5 * width
    about = np.clip(middles, half, travel[-1] - half)
    first, last = np.searchsorted(travel, [about - half, about + half])
    lacking = np.maximum(_FEWEST - (last - first), 0)
    first = np.clip(first - lacking // 2, 0, travel.size - _FEWEST)
    return [(int(a), int(b)) for a, b in zip(first, np.maximum(last, first + _FEWEST), strict=True)]


def _slope(angle: Array, time: Array, at: float) -> tuple[float, float]:
    """Slope of the parabola through angles (k,) over time, at one time, and its standard error."""
    scale = float(np.ptp(time))
    powers = np.vander((time - at) / scale, 3, increasing=True)
    inverse = np.linalg.inv(powers.T @ powers)
    found = inverse @ (powers.T @ (angle - angle[0]))
    left = angle - angle[0] - powers @ found
    variance = float(left @ left) / (left.size - 3)
    return float(found[1]) / scale, float(np.sqrt(variance * inverse[1, 1])) / scale


def two_speeds_alone(speed: Array) -> bool:
    """Whether speeds (n,), unless all are one, are those of two steady motions, but for a hundredth of the readings."""
    rising = np.sort(np.abs(speed))
    # A few readings far from all others would be a group of their own.
    few = int(_SELDOM * rising.size)
    rising = rising[few : rising.size - few]
    if rising.size < 2:
        return True
    between = 1 + int(np.argmax(rising[1:] / np.maximum(rising[:-1], 1e-300)))
    for group in (rising[:between], rising[between:]):
        slow, fast = np.quantile(group, [_SELDOM, 1.0 - _SELDOM])
        if fast - slow > LEAST_SPEEDS * fast:
            return False
    return True
