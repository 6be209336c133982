"""What the shaft does: the conditions under which each reading is taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from twin.angles import TAU, Array, IntArray, wrap
from twin.direction import as_reached, way_of
from twin.estimated_motion import EstimatedMotion
from twin.pace import LEAST_SPEEDS, speed_over_time, two_speeds_alone
from twin.recordings import Recordings, Setup
from twin.runs import runs
from twin.whole_counts import WholeCounts, whole_counts

LEAST_FIELD_RATIO = 1.1
"""Between two recordings, from which on what follows the field is told from what does not."""
LEAST_TURN_RAD = 0.17
"""Turn of the sensor between two recordings, about 10 deg, from which on its errors are told from the reference's."""

RPM = TAU / 60.0
"""One revolution a minute [rad/s]."""
KRPM = 1000.0 * RPM
"""1000 rpm [rad/s]."""
LEAST_SPAN_K = 5.0
"""Span of temperatures, or difference between two recordings, from which on drifts may show."""
LEAST_CURRENTS = 0.2
"""Span of the motor's currents, as a share of the largest, from which on what follows them may show."""
AT_ONE_ANGLE_RAD = 1e-4
"""Turn below which two readings were taken at one angle."""
NOMINAL_C = 25.0
"""Temperature [C] at which figures are stated, from which drifts count, and of readings that record none."""


@dataclass(frozen=True, eq=False)
class Motion:
    """Shaft angle and conditions, one row a reading, in the order in which they were taken.

    Made by :meth:`from_angle`, or from a recording by :meth:`twin.Sweep.motion`.

    Attributes
    ----------
    shaft_rad : ndarray
        Shaft angle [rad], (n,), unwrapped.
    time_s, direction, speed_rad_s, turn, temperature_c : ndarray
        Time [s], +1 or -1, signed speed [rad/s], number of the turn or sweep from 0, temperature [C]; (n,) each.
    columns : frozenset of str
        What the bench recorded itself: ``time_s``, ``direction``, ``speed_rpm``, ``turn``, ``temperature_c``, ``vx``,
        ``current_a``. What was not recorded is inferred where the rows allow it (direction from their order, speed from
        dense time stamps), else zero, and 25 C.
    recordings : Recordings or None
        Of several recordings one behind the other: which one each reading belongs to. None: all are of one.
    current_a : ndarray
        Current of the motor that turns the shaft [A], (n,); without one given, zero.
    estimated : EstimatedMotion or None
        Where no reference was recorded and the motion is estimated from the sensor's readings: how freely the shaft
        may have moved beside that. None: a reference was recorded.
    """

    shaft_rad: Array
    time_s: Array
    direction: Array
    speed_rad_s: Array
    turn: IntArray
    temperature_c: Array
    columns: frozenset[str] = frozenset()
    recordings: Recordings | None = None
    current_a: Array = field(default_factory=lambda: np.zeros(0))
    estimated: EstimatedMotion | None = None

    def __post_init__(self) -> None:
        if not self.current_a.size:
            object.__setattr__(self, "current_a", np.zeros(np.shape(self.shaft_rad)))
        # Views that cannot be written to: an effect that changed its motion would change it for all that come after.
        for name in ("shaft_rad", "time_s", "direction", "speed_rad_s", "turn", "temperature_c", "current_a"):
            view = getattr(self, name).view()
            view.flags.writeable = False
            object.__setattr__(self, name, view)

    def __repr__(self) -> str:
        recorded = ", ".join(sorted(self.columns)) or "the angle alone"
        return f"Motion({len(self)} readings, {self.turns:.4g} turns, recorded: {recorded})"

    def __len__(self) -> int:
        return int(self.shaft_rad.shape[-1])

    @classmethod
    def from_angle(
        cls,
        shaft_rad: Array,
        *,
        time_s: Array | None = None,
        direction: Array | None = None,
        speed_rad_s: Array | None = None,
        turn: Array | None = None,
        temperature_c: Array | None = None,
        current_a: Array | None = None,
        has_channels: bool = False,
    ) -> Motion:
        """Complete a motion from what is known of it.

        Parameters
        ----------
        shaft_rad : ndarray
            Shaft angle [rad], (n,), wrapped or not.
        time_s, direction, speed_rad_s, turn, temperature_c, current_a : ndarray, optional
            What was recorded beside it, (n,) each; a speed may be unsigned. A missing temperature or current (NaN) is
            taken from its neighbours in row order.
        has_channels : bool, optional
            Whether the two channels are recorded too.

        Returns
        -------
        Motion
            With direction, speed and all else that was not recorded inferred, or at its default.

        Examples
        --------
        >>> import numpy as np
        >>> from twin import Motion
        >>> Motion.from_angle(np.radians([0.0, 120.0, 240.0, 0.0, 120.0]))
        Motion(5 readings, 1.333 turns, recorded: the angle alone)
        """
        wrapped = np.asarray(shaft_rad, dtype=np.float64)
        n = wrapped.size
        shaft = wrapped if n == 0 else np.concatenate([wrapped[:1], wrapped[0] + np.cumsum(wrap(np.diff(wrapped)))])
        way = as_reached(shaft, way_of(shaft, direction, speed_rad_s))
        speed = _speed(shaft, way, time_s, speed_rad_s)
        temperature, current = _without_gaps(temperature_c), _without_gaps(current_a)
        recorded = {
            "time_s": time_s is not None,
            "direction": direction is not None,
            "speed_rpm": speed_rad_s is not None,
            "turn": turn is not None,
            "temperature_c": temperature is not None,
            "vx": has_channels,
            "current_a": current is not None,
        }
        return cls(
            shaft_rad=shaft,
            time_s=np.arange(n, dtype=np.float64) if time_s is None else np.asarray(time_s, dtype=np.float64),
            direction=way,
            speed_rad_s=speed,
            turn=np.zeros(n, dtype=np.int64)
            if turn is None
            else np.unique(turn, return_inverse=True)[1].astype(np.int64),
            temperature_c=np.full(n, NOMINAL_C) if temperature is None else temperature,
            columns=frozenset(name for name, given in recorded.items() if given),
            current_a=np.zeros(n) if current is None else current,
        )

    def part(self, rows: IntArray) -> Motion:
        """Only these rows (m,) of the motion, with the turns numbered anew."""
        found = replace(
            self,
            shaft_rad=self.shaft_rad[rows],
            time_s=self.time_s[rows],
            direction=self.direction[rows],
            speed_rad_s=self.speed_rad_s[rows],
            turn=np.unique(self.turn[rows], return_inverse=True)[1].astype(np.int64),
            temperature_c=self.temperature_c[rows],
            current_a=self.current_a[rows],
            estimated=None if self.estimated is None else self.estimated.part(rows),
            recordings=None if self.recordings is None else self.recordings.part(rows),
        )
        # Where between two counts a reading was taken is told by those around it, in the part or not.
        whole = None if self.whole_counts is None else self.whole_counts.part(rows)
        found.__dict__.update(recorded_rad=self.recorded_rad[rows], whole_counts=whole)
        return found

    def averaged(self, group: IntArray) -> Motion:
        """Means over groups of rows, (n,) numbers from 0 in their order; what is no quantity is that of the first."""
        many = np.bincount(group)
        first = np.searchsorted(group, np.arange(many.size)).astype(np.int64)

        def mean(values: Array) -> Array:
            return np.asarray(np.bincount(group, values) / many)

        found = replace(
            self,
            shaft_rad=mean(self.shaft_rad),
            time_s=mean(self.time_s),
            direction=self.direction[first],
            speed_rad_s=mean(self.speed_rad_s),
            turn=self.turn[first],
            temperature_c=mean(self.temperature_c),
            current_a=mean(self.current_a),
            estimated=None if self.estimated is None else self.estimated.averaged(group),
            recordings=None if self.recordings is None else self.recordings.part(first),
        )
        whole = None if self.whole_counts is None else self.whole_counts.averaged(group)
        found.__dict__.update(recorded_rad=mean(self.recorded_rad), whole_counts=whole)
        return found

    def at(self, shaft_rad: Array) -> Motion:
        """The same record, of a shaft that stood at other angles (n,) than the reference reads."""
        return self._with(shaft_rad=shaft_rad)

    def _with(self, **changed: Any) -> Motion:
        """The same record with other fields; what its reference read, and what that tells, stays as it is."""
        found = replace(self, **changed)
        found.__dict__.update(recorded_rad=self.recorded_rad, whole_counts=self.whole_counts)
        return found

    @classmethod
    def joined(cls, parts: Sequence[Motion], setups: Sequence[Setup]) -> Motion:
        """Recordings of one device as one motion: angles, times and turns go on from one to the next.

        Parameters
        ----------
        parts : sequence of Motion
            The motion of each recording.
        setups : sequence of Setup
            How the bench was set up in each.

        Returns
        -------
        Motion
            With the columns that all recordings have.
        """
        shaft, time, turn = [parts[0].shaft_rad], [parts[0].time_s], [parts[0].turn]
        for part in parts[1:]:
            before = float(shaft[-1][-1])
            shaft.append(part.shaft_rad + TAU * np.round((before - part.shaft_rad[0]) / TAU))
            step = float(np.median(np.diff(part.time_s))) if len(part) > 1 else 1.0
            time.append(part.time_s + (float(np.max(time[-1])) + step - float(np.min(part.time_s))))
            turn.append(part.turn + (int(turn[-1].max()) + 1))
        number = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
        return cls(
            shaft_rad=np.concatenate(shaft),
            time_s=np.concatenate(time),
            direction=np.concatenate([part.direction for part in parts]),
            speed_rad_s=np.concatenate([part.speed_rad_s for part in parts]),
            turn=np.concatenate(turn),
            temperature_c=np.concatenate([part.temperature_c for part in parts]),
            columns=frozenset.intersection(*(part.columns for part in parts)),
            current_a=np.concatenate([part.current_a for part in parts]),
            estimated=EstimatedMotion.joined([part.estimated for part in parts], [len(part) for part in parts]),
            recordings=Recordings(number, tuple(setups)),
        )

    @cached_property
    def parts(self) -> tuple[Motion, ...]:
        """The motion of each recording by itself; of a single one this very motion."""
        recordings, rows = self.recordings, np.arange(len(self))
        if recordings is None or len(recordings) == 1:
            return (self,)
        each = [(rows[one], setup) for one, setup in zip(recordings.slices, recordings.setups, strict=True)]
        return tuple(self.part(own)._with(recordings=Recordings(np.zeros_like(own), (setup,))) for own, setup in each)

    @cached_property
    def recorded_rad(self) -> Array:
        """What the reference read [rad], (n,): the shaft's angles, unless these were found from it (see :meth:`at`)."""
        return self.shaft_rad

    @cached_property
    def whole_counts(self) -> WholeCounts | None:
        """Where the shaft stood between two counts of a reference that reads in steps, where its even motion tells."""
        return whole_counts(self.recorded_rad) if self.estimated is None else None

    @cached_property
    def segments(self) -> tuple[tuple[int, int, float], ...]:
        """Stretches of constant direction: (first row, one past the last row, direction)."""
        return tuple((rows.start, rows.stop, float(self.direction[rows.start])) for rows in runs(self.direction))

    @cached_property
    def travel_rad(self) -> Array:
        """Path of the shaft [rad] since the first row, ever growing."""
        return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(self.shaft_rad)))]) if len(self) else np.zeros(0)

    @cached_property
    def acceleration_rad_s2(self) -> Array:
        """Angular acceleration (n,) [rad/s^2], from the speed over time; zero where the clock stands still."""
        if len(self) < 2:
            return np.zeros(len(self))
        step = np.diff(self.time_s)
        rate = np.divide(np.diff(self.speed_rad_s), step, out=np.zeros_like(step), where=step > 0.0)
        # Each reading lies between two steps, each of which tells the more the shorter it is, as in a parabola.
        before, after = np.concatenate([rate[:1], rate]), np.concatenate([rate, rate[-1:]])
        left, right = np.concatenate([step[:1], step]), np.concatenate([step, step[-1:]])
        both = left + right
        found: Array = np.divide(before * right + after * left, both, out=np.zeros_like(both), where=both > 0.0)
        return found

    @cached_property
    def turns(self) -> float:
        """How many turns the shaft has travelled, both directions counted."""
        if self.recordings is not None and len(self.recordings) > 1:
            # From where one recording ended to where the next began nobody has turned it.
            return sum(part.turns for part in self.parts)
        return float(self.travel_rad[-1] / TAU) if len(self) else 0.0

    @cached_property
    def points_per_turn(self) -> float:
        """Distinct angles a turn of travel: readings repeated in place count once."""
        moved = int(np.count_nonzero(np.abs(np.diff(self.shaft_rad)) > AT_ONE_ANGLE_RAD))
        return (moved + 1) / max(self.turns, 1e-9) if self.turns > 0.5 else float(moved + 1)

    @cached_property
    def angles_in_a_turn(self) -> float:
        """Angles of the turn at which there are readings, by the widest gap between two: all turns laid on one another.

        Readings of many turns that do not fall on the same angles tell finer structure than those of one turn do.
        """
        if len(self) < 2:
            return self.points_per_turn
        places = np.sort(np.mod(self.shaft_rad, TAU))
        widest = float(max(np.max(np.diff(places)), places[0] + TAU - places[-1]))
        return max(self.points_per_turn, TAU / (widest + AT_ONE_ANGLE_RAD))

    @cached_property
    def provides(self) -> frozenset[str]:
        """What effects may need of a motion and this one has: recorded columns, and properties of the protocol."""
        found = set(self.columns)
        if self.recordings is not None and len(self.recordings) > 1:
            return frozenset(found.union(*(part.provides for part in self.parts)) | self._by_recordings())
        if len({way for _, _, way in self.segments}) == 2:
            found.add("both directions")
        # A few rows about a reversal or a stop are no second speed.
        slow, fast = np.quantile(np.abs(self.speed_rad_s), [0.02, 0.98]) if len(self) else (0.0, 0.0)
        if fast - slow > LEAST_SPEEDS * fast:
            found.add("two speeds")
        if not two_speeds_alone(self.speed_rad_s):
            found.add("three speeds")
        if np.any(self.speed_rad_s != 0.0):
            found.add("moving shaft")
        # Where the bench goes from one steady speed to the next, a few rows alone are accelerated.
        if "time_s" in self.columns and _mostly_there(np.abs(self.acceleration_rad_s2)):
            found.add("varying speed")
        if np.ptp(self.shaft_rad) > 0.95 * TAU * (1 - 1 / max(self.points_per_turn, 2)):
            found.add("one turn")
        if np.ptp(self.shaft_rad) > 1.8 * TAU:
            found.add("several turns")
        found |= self._levels() | self._of_the_reference()
        if self.turn.max(initial=0) > 0:
            found.add("two turns")
        return frozenset(found)

    def _levels(self) -> set[str]:
        """Conditions that were recorded at more than one level."""
        shown = {
            "two temperatures": np.ptp(self.temperature_c) > LEAST_SPAN_K,
            "two currents": np.ptp(self.current_a) > LEAST_CURRENTS * np.max(np.abs(self.current_a)),
        }
        return {name for name, has in shown.items() if has}

    def _of_the_reference(self) -> set[str]:
        """Whether there is one, and whether it shows where the shaft stood between two of its counts."""
        shown = {"a reference": self.estimated is None, "whole counts": self.whole_counts is not None}
        return {name for name, has in shown.items() if has}

    def _by_recordings(self) -> set[str]:
        """What the recordings provide together, and none of them alone."""
        assert self.recordings is not None
        setups = self.recordings.setups
        pace = np.abs(self.speed_rad_s)
        slow, fast = np.quantile(pace, [0.02, 0.98])
        turned = np.radians([setup.turned_deg for setup in setups])
        shown = {
            "both directions": np.ptp(self.direction) > 0.0,
            "two speeds": fast - slow > LEAST_SPEEDS * fast,
            "three speeds": not two_speeds_alone(self.speed_rad_s),
            "two temperatures": np.ptp(self.temperature_c) > LEAST_SPAN_K,
            "two air gaps": max(setup.field for setup in setups) > LEAST_FIELD_RATIO * min(one.field for one in setups),
            "two mountings": float(np.max(np.abs(np.exp(1j * (turned - turned[0])) - 1.0))) > LEAST_TURN_RAD,
        }
        return {name for name, has in shown.items() if has}


def _mostly_there(size: Array) -> bool:
    """Whether half of all rows have a fair share (1/50) of the largest."""
    return bool(size.size and float(np.median(size)) > 0.02 * float(np.max(size)))


def _speed(shaft_rad: Array, way: Array, time_s: Array | None, speed_rad_s: Array | None) -> Array:
    """Signed speed [rad/s] (n,): as recorded, else from time stamps dense enough for a shaft in motion, else zero."""
    if speed_rad_s is not None:
        # A recorded speed may be unsigned: its sense is the direction's.
        return np.asarray(np.abs(np.asarray(speed_rad_s, dtype=np.float64)) * way)
    if time_s is None or shaft_rad.size < 3:
        return np.zeros(shaft_rad.size)
    return speed_over_time(shaft_rad, np.asarray(time_s), way)


def _without_gaps(column: Array | None) -> Array | None:
    """A column (n,), missing cells taken from their neighbours in row order; None where there is no cell at all."""
    if column is None or not np.isfinite(column).any():
        return None
    known = np.flatnonzero(np.isfinite(column))
    return np.asarray(np.interp(np.arange(np.size(column)), known, np.asarray(column)[known]))
