"""Observations: a sweep prepared for fitting; repeats at one angle averaged, rows that are not for the mean masked."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from diagnosis.discovery.fitting.repeats import Repeats
from diagnosis.spin.torques import Loose, found_torques, torque_columns
from twin.angles import Array, IntArray, wrap
from twin.effect import BoolArray
from twin.motion import Motion
from twin.noise.description import Noise
from twin.sweep import Sweep

MOST_ROWS = 12_000
"""Longer records are averaged over blocks of readings, as long as a turn keeps the points that follow."""
DENSE_POINTS = 360
_BEYOND_CHANCE = 2.0


@dataclass(frozen=True, eq=False)
class Observations:
    """Rows that count as independent angles, arrays of shape (n,).

    ``motion`` holds the reference's readings as shaft angles. ``log_radius`` is log |(vx, vy)| where the channels
    were recorded. ``usable`` masks rows out of the fits of the mean (outliers, repeats of stale frames, held-out
    blocks); rows that are not ``sure`` are out for good, their direction being in doubt. ``scale`` is the noise of a
    row against the usual one, and ``level`` the part of it that its whole recording has. ``group`` maps each raw row to
    its row here, and ``ahead`` (n_raw,) [rad] is how much further the reading of a raw row is expected to be than that
    of its row, the shaft having moved meanwhile. ``repeat_rms`` [rad] is the scatter of readings that became one row,
    ``within`` the mean square [rad^2] over all readings that averaging them has taken away. ``repeats`` are the
    readings repeated at one angle, where the bench stood still for some.
    """

    motion: Motion
    measured: Array
    log_radius: Array | None
    usable: BoolArray
    sure: BoolArray
    scale: Array
    group: IntArray
    ahead: Array
    repeat_rms: float | None
    within: float
    level: Array
    repeats: Repeats | None = None

    def __len__(self) -> int:
        return int(self.measured.size)

    @property
    def observables(self) -> int:
        """1 for the angle alone, 2 with the radius."""
        return 1 if self.log_radius is None else 2

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """Rows of each recording, or stretch of one: noise is not correlated from one to the next."""
        if self.motion.estimated is not None:
            return self.motion.estimated.lengths
        recordings = self.motion.recordings
        return (len(self),) if recordings is None else recordings.lengths

    @cached_property
    def motion_spectrum(self) -> Array | float:
        """What the shaft may have done beside the motion, against the noise, over the cosine coefficients (n,).

        0 where a reference was recorded.
        """
        return 0.0 if self.motion.estimated is None else self.motion.estimated.spectrum

    def noise_spectrum(self, noise: Noise) -> Array:
        """Spectrum (n,) of a noise over the cosine coefficients of the rows, sequence by sequence."""
        return np.concatenate([noise.spectrum(length) for length in self.lengths])

    def spectrum(self, noise: Noise) -> Array:
        """The same with what the shaft may have done beside the motion."""
        return self.noise_spectrum(noise) + self.motion_spectrum

    @cached_property
    def loose(self) -> Loose | None:
        """What torques locked to the angle may have done to an estimated motion; None: nothing."""
        columns = torque_columns(self.motion)
        if not len(columns):
            return None
        found = self.motion.estimated
        assert found is not None
        return Loose(columns, self.usable, found.noise_rad, found.spectrum, found.lengths)

    @cached_property
    def torques(self) -> Array | float:
        """Angle (n,) [rad] by which torques locked to the angle turn an estimated motion; 0 where none are loose."""
        return 0.0 if self.loose is None else found_torques(self.motion)

    def masked(self, usable: BoolArray) -> Observations:
        """The same rows with another mask."""
        return replace(self, usable=usable)


def collect(sweep: Sweep) -> Observations:
    """Prepare a sweep. Consecutive readings at one angle are one row: ten readings are not ten angles."""
    motion = sweep.motion()
    measured = np.radians(sweep.measured_deg)
    group = _repeats(motion)
    count: IntArray = np.bincount(group)
    repeat_rms, within, repeats = None, 0.0, None
    ahead = np.zeros(count.sum())
    if count.max() > 1:
        first: IntArray = np.searchsorted(group, np.arange(count.size)).astype(np.int64)
        deviation = wrap(measured - measured[first][group])
        mean = np.bincount(group, deviation) / count
        raw = motion.shaft_rad
        motion = motion.averaged(group)
        sense = np.sign(np.sum(wrap(np.diff(measured)) * np.diff(raw)))
        ahead = sense * (raw - motion.shaft_rad[group])
        off = deviation - mean[group] - ahead
        squares = float(np.sum(off**2))
        if _in_place(sweep.motion()):
            repeats = Repeats.of(off, group)
        repeat_rms = float(np.sqrt(squares / max(int(np.sum(count - 1)), 1)))
        within = squares / group.size
        measured = measured[first] + mean
    log_radius = None
    if sweep.vx is not None and sweep.vy is not None:
        radius = np.hypot(np.bincount(group, sweep.vx) / count, np.bincount(group, sweep.vy) / count)
        if np.all(radius > 0.0):
            log_radius = np.log(radius)
    n = count.size
    sure = _sure_of_direction(motion, sweep)
    return Observations(
        motion=motion,
        measured=measured,
        log_radius=log_radius,
        usable=sure,
        sure=sure,
        scale=np.ones(n),
        group=group,
        ahead=ahead,
        repeat_rms=repeat_rms,
        within=within,
        level=np.ones(n),
        repeats=repeats,
    )


def of_readings(row_rms_deg: float, observations: Observations) -> float:
    """RMS [deg] over single readings, from that over rows which average several of them."""
    return float(np.hypot(row_rms_deg, np.degrees(np.sqrt(observations.within))))


def block_length(motion: Motion, rows: int | None = None) -> int:
    """Readings that are averaged into one row: 1 but for long records far denser than any structure searched for.

    ``rows`` are those of the whole record, where the motion is of a piece of it.
    """
    if _in_place(motion):
        return 1
    return max(1, min(-(-(rows or len(motion)) // MOST_ROWS), int(motion.points_per_turn // DENSE_POINTS)))


def _in_place(motion: Motion) -> bool:
    """Whether readings are repeated at one angle: the shaft stands still between many of them."""
    return bool(np.mean(_stands_still(motion)) >= 0.4)


def _stands_still(motion: Motion) -> BoolArray:
    """Which steps (n-1,) from reading to reading are none: short ones, unless one after another they lead onward.

    A bench that samples more finely for a while, as after a reversal, takes short steps that add up: to the length of
    one that is not short, or to more than twice what steps to and fro of their size would.
    """
    step = np.diff(motion.shaft_rad)
    longest = 0.1 * np.quantile(np.abs(step), 0.95)
    short = np.abs(step) < longest
    together = short & _same_way(motion)
    run = np.cumsum(~together)
    travel = np.abs(np.bincount(run, np.where(together, step, 0.0)))
    by_chance = np.sqrt(np.bincount(run, np.where(together, step**2, 0.0)))
    onward = travel > np.minimum(longest, _BEYOND_CHANCE * by_chance)
    return np.asarray(short & ~(together & onward[run]))


def _same_way(motion: Motion) -> BoolArray:
    """Which steps (n-1,) neither turn round nor begin another turn."""
    return np.asarray((np.diff(motion.turn) == 0) & (np.diff(motion.direction) == 0))


def _repeats(motion: Motion) -> IntArray:
    """For each row the number of its group; groups of one unless the bench stood still between most readings.

    A record far denser than any structure searched for is averaged over short blocks.
    """
    n = len(motion)
    if not _in_place(motion):
        block = block_length(motion)
        if block < 2:
            return np.arange(n)
        # A block ends where the direction, the turn or the pace changes.
        pace = np.abs(np.diff(motion.speed_rad_s)) > 0.05 * max(float(np.max(np.abs(motion.speed_rad_s))), 1e-9)
        ends = (np.diff(motion.turn) != 0) | (np.diff(motion.direction) != 0) | pace
        if motion.estimated is not None:
            ends |= np.diff(motion.estimated.stretch) != 0
        part = np.concatenate([[0], np.cumsum(ends)])
        start = np.concatenate([[0], np.flatnonzero(ends) + 1])
        inside = (np.arange(n) - start[part]) // block
        return np.concatenate([[0], np.cumsum((np.diff(part) != 0) | (np.diff(inside) != 0))])
    return np.concatenate([[0], np.cumsum(~(_stands_still(motion) & _same_way(motion)))])


def _sure_of_direction(motion: Motion, sweep: Sweep) -> BoolArray:
    """All rows but those about a reversal whose direction is only inferred: it may be a row sooner or later."""
    usable = np.ones(len(motion), dtype=bool)
    signed = sweep.speed_rpm is not None and np.ptp(np.sign(sweep.speed_rpm)) == 2.0
    if sweep.direction is None and not signed:
        for first, _, _ in motion.segments[1:]:
            usable[max(first - 1, 0) : first + 1] = False
    return usable
