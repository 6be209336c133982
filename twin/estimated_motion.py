"""A motion that no reference recorded: how freely the shaft may have moved beside what was estimated of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from twin.angles import Array, IntArray
from twin.runs import runs
from twin.second_inertia import Tied

SPECTRAL_SLOPE = 6
"""Of a motion's spectrum over frequency: that of an angle whose torque is a random walk."""
_LOUDEST = 1e12
"""Of a motion against the noise: from there on more of it makes no difference in double precision."""


@dataclass(frozen=True, kw_only=True)
class Torque:
    """A torque locked to the shaft's angle, of one order.

    Attributes
    ----------
    order : int
        Periods a turn.
    cos_rad_s2, sin_rad_s2 : float
        The angular accelerations that go with cosine and sine of the angle [rad/s^2].
    sd_rad_s2 : float
        Standard deviation of their errors.
    scatter_rad_s2, growing_rad_s, reversing_rad_s2 : float
        Standard deviations of what such a torque may be, of the part that does not depend on the speed [rad/s^2], of
        that which grows with it [rad/s^2 for each rad/s] and of that which reverses with it [rad/s^2]; 0: none is taken
        to be there.
    separable : bool
        Whether the speeds of the log tell such a torque, were it as large as to make all that is seen of this order,
        from an error of the sensor.
    """

    order: int
    cos_rad_s2: float = 0.0
    sin_rad_s2: float = 0.0
    sd_rad_s2: float = 0.0
    scatter_rad_s2: float = 0.0
    growing_rad_s: float = 0.0
    reversing_rad_s2: float = 0.0
    separable: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class EstimatedMotion:
    """What goes with a motion that was estimated from the sensor's readings.

    Attributes
    ----------
    stretch : ndarray
        Number of the stretch without a stop or a gap that each reading (n,) is of, never falling.
    knee_rad : ndarray
        Angular frequency [rad a row], (n,), at which the motion is as free as a reading is noisy: slower, an error of
        the sensor cannot be told from a movement of the shaft. 0 where a reference was recorded.
    noise_rad : float
        RMS [rad] of a reading, or of a mean of readings, about the motion.
    torques : tuple of Torque
        What was found of torques locked to the angle, order by order.
    damping_per_s : float
        Rate at which friction and the drive undo a departure from the speed [1/s].
    damping_sd_per_s : float
        Standard deviation of its error.
    second : Tied or None
        What a belt or a coupling ties to the rotor; None: the rotor turns as one piece.
    rows_aside : int
        Readings of the log that tell nothing: at standstill, in a jerk, or far off.
    even_clock : bool
        Whether the readings were taken to be evenly spaced, their time stamps being coarser than their spacing or none.
    """

    stretch: IntArray
    knee_rad: Array
    noise_rad: float
    torques: tuple[Torque, ...] = field(default=())
    damping_per_s: float = 0.0
    damping_sd_per_s: float = 0.0
    second: Tied | None = None
    rows_aside: int = 0
    even_clock: bool = False

    def part(self, rows: IntArray) -> EstimatedMotion | None:
        """Only these rows (m,); where rows are left out between two, a stretch ends. None: all have a reference."""
        if not np.any(self.knee_rad[rows]):
            return None
        broken = (np.diff(rows) != 1) | (np.diff(self.stretch[rows]) != 0)
        stretch = np.concatenate([[0], np.cumsum(broken)]).astype(np.int64) if rows.size else self.stretch[rows]
        return replace(self, stretch=stretch, knee_rad=self.knee_rad[rows])

    def averaged(self, group: IntArray) -> EstimatedMotion:
        """Of rows that are averaged by groups (n,), numbered from 0."""
        count = np.bincount(group)
        first = np.searchsorted(group, np.arange(count.size))
        # The motion stays what it is, while the mean of several readings is less noisy than one.
        noise_rad = self.noise_rad / float(np.sqrt(np.mean(count)))
        return replace(self, stretch=self.stretch[first], knee_rad=self.knee_rad[first] * count, noise_rad=noise_rad)

    def at_noise(self, noise_rad: float) -> EstimatedMotion:
        """The same motion, as free as it is, against readings of this noise [rad]."""
        knee_rad = self.knee_rad * (self.noise_rad / noise_rad) ** (2.0 / SPECTRAL_SLOPE)
        return replace(self, knee_rad=knee_rad, noise_rad=noise_rad)

    @classmethod
    def joined(cls, parts: Sequence[EstimatedMotion | None], lengths: Sequence[int]) -> EstimatedMotion | None:
        """Of several recordings one behind the other, None standing for one with a reference; None: all are.

        Torques are those of one rotor, told by all recordings together.
        """
        known = [part for part in parts if part is not None]
        if not known:
            return None
        stretch, knee, at = [], [], 0
        for part, length in zip(parts, lengths, strict=True):
            own = np.zeros(length, dtype=np.int64) if part is None else part.stretch - part.stretch[0]
            stretch.append(own + at)
            knee.append(np.zeros(length) if part is None else part.knee_rad)
            at = int(stretch[-1][-1]) + 1
        return cls(
            stretch=np.concatenate(stretch),
            knee_rad=np.concatenate(knee),
            noise_rad=float(np.median([part.noise_rad for part in known])),
            torques=known[0].torques,
            damping_per_s=known[0].damping_per_s,
            damping_sd_per_s=known[0].damping_sd_per_s,
            second=known[0].second,
            rows_aside=sum(part.rows_aside for part in known),
            even_clock=any(part.even_clock for part in known),
        )

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """The rows of each stretch."""
        return runs(self.stretch)

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """Readings of each stretch."""
        return tuple(rows.stop - rows.start for rows in self.slices)

    @cached_property
    def spectrum(self) -> Array:
        """Variance (n,) of the motion over that of the noise, for the cosine coefficients of each stretch."""
        out = []
        for rows, length in zip(self.slices, self.lengths, strict=True):
            knee = float(np.median(self.knee_rad[rows])) * length / np.pi
            with np.errstate(divide="ignore"):
                over = (knee / np.arange(length)) ** SPECTRAL_SLOPE if knee > 0.0 else np.zeros(length)
            out.append(np.minimum(over, _LOUDEST))
        return np.concatenate(out)
