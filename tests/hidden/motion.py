"""What the shaft does during a sweep, and what a protocol can be asked for."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Motion:
    """One entry per reading, in the order taken; all arrays have shape (n,)."""

    protocol: str
    points_per_turn: int
    repeats: int
    """Readings taken at each angle."""
    moving: bool
    time_s: Array
    shaft_deg: Array
    """True shaft angle, unwrapped."""
    direction: Array
    """In which the shaft came to the reading."""
    named: Array
    """The direction that the bench writes down: that of the leg, also where the shaft turns at its first reading."""
    speed_rpm: Array
    """Signed; zero where the bench stops to measure."""
    turn: Rows
    temperature_c: Array

    @property
    def speed_deg_s(self) -> Array:
        """Signed shaft speed, degrees per second."""
        return 6.0 * self.speed_rpm

    @property
    def travel_deg(self) -> Array:
        """Shaft travel since the reading before, signed; 0 at the first."""
        return np.diff(self.shaft_deg, prepend=self.shaft_deg[0])

    @property
    def turns(self) -> int:
        """Number of distinct turns."""
        return int(self.turn.max()) + 1

    @property
    def finest_step_s(self) -> float:
        """Shortest time between readings."""
        return float(np.min(np.diff(self.time_s)))

    @property
    def warmth(self) -> Array:
        """T - 25 C."""
        return self.temperature_c - 25.0


@dataclass(frozen=True)
class Demands:
    """What a cause asks of the sweep beyond the choice of protocol."""

    turns: int = 1
    points: int = 0
    """Least points a turn."""
    channels: bool = False
    turn_column: bool = False
    time_column: bool = False
    single_readings: bool = False
    """No repeats at one angle."""
    mains_free: bool = False
    """At one speed, 50 and 60 Hz must not fall on whole orders."""

    def __or__(self, other: Demands) -> Demands:
        return Demands(
            turns=max(self.turns, other.turns),
            points=max(self.points, other.points),
            channels=self.channels or other.channels,
            turn_column=self.turn_column or other.turn_column,
            time_column=self.time_column or other.time_column,
            single_readings=self.single_readings or other.single_readings,
            mains_free=self.mains_free or other.mains_free,
        )


NO_DEMANDS = Demands()


@dataclass(frozen=True)
class Leg:
    """A stretch of one direction, speed and temperature."""

    turns: int
    direction: int
    rpm: float = 0.0
    temperature_c: float = 25.0
    pause_s: float = 0.0
    """Waiting before the first reading."""


@dataclass(frozen=True)
class Layout:
    """How the legs become rows."""

    points_per_turn: int
    start_deg: float
    jitter_deg: float
    """Standard deviation of the shaft about its evenly spaced stops."""
    uneven: float = 0.0
    """Half width of a uniform spread, as a share of the spacing."""
    dwell_s: float = 0.4
    start_s: float = 0.0
    repeats: int = 1
    reversal: str = "overrun"
    """overrun: one step further before turning back; same: the last angle once more; back: one step back."""
    legs: tuple[Leg, ...] = field(default_factory=tuple)


def positions(layout: Layout) -> tuple[Rows, Rows]:
    """Step number and leg number of every stop, shape (stops,) each."""
    steps: list[Rows] = []
    legs: list[Rows] = []
    following = 0
    last_direction = layout.legs[0].direction
    for number, leg in enumerate(layout.legs):
        if leg.direction != last_direction:
            # `following` is where the old direction would have gone next
            following += {"overrun": 0, "same": -1, "back": -2}[layout.reversal] * last_direction
        count = leg.turns * layout.points_per_turn
        steps.append(following + leg.direction * np.arange(count))
        legs.append(np.full(count, number))
        following += leg.direction * count
        last_direction = leg.direction
    return np.concatenate(steps), np.concatenate(legs)


def run(protocol: str, layout: Layout, rng: np.random.Generator) -> Motion:
    """Carry out a layout."""
    step_deg = 360.0 / layout.points_per_turn
    step, leg = positions(layout)
    stops = len(step)
    wander = layout.jitter_deg * rng.standard_normal(stops)
    wander += layout.uneven * step_deg * rng.uniform(-1.0, 1.0, stops)

    legs = layout.legs
    rpm = np.array([one.rpm for one in legs])[leg]
    named = np.array([float(one.direction) for one in legs])[leg]
    moving = bool(np.any(rpm > 0))
    with np.errstate(divide="ignore"):
        each_s = np.where(rpm > 0, step_deg / (6.0 * rpm), layout.dwell_s * layout.repeats)
    before = layout.start_s + np.concatenate([[0.0], np.cumsum(each_s)[:-1]])
    first = np.diff(leg, prepend=-1) > 0
    # one step further: reached before the shaft turns
    turned = first & (np.diff(named, prepend=named[0]) != 0) & (layout.reversal == "overrun")
    direction = np.where(turned, -named, named)
    before += np.cumsum(np.where(first, np.array([one.pause_s for one in legs])[leg], 0.0))
    if moving and layout.uneven > 0:
        # a shaft at constant speed is early or late by the angle it is off
        before += wander * direction / (6.0 * rpm)
        before += layout.start_s - before[0]

    revolution = np.zeros(stops, dtype=np.int64)
    for number in range(len(legs)):
        rows = leg == number
        start = 0 if number == 0 else int(revolution[np.flatnonzero(rows)[0] - 1]) + 1
        revolution[rows] = start + np.arange(int(rows.sum())) // layout.points_per_turn

    again = layout.repeats
    within = np.tile(np.arange(again), stops) * (layout.dwell_s if again > 1 else 0.0)
    return Motion(
        protocol=protocol,
        points_per_turn=layout.points_per_turn,
        repeats=again,
        moving=moving,
        time_s=np.repeat(before, again) + within,
        shaft_deg=np.repeat(layout.start_deg + step * step_deg + wander, again),
        direction=np.repeat(direction, again),
        named=np.repeat(named, again),
        speed_rpm=np.repeat(rpm * direction, again),
        turn=np.repeat(revolution, again),
        temperature_c=np.repeat(np.array([one.temperature_c for one in legs])[leg], again),
    )


def on_the_move(
    protocol: str, *, time_s: Array, shaft_deg: Array, speed_deg_s: Array, points: int, turn: Rows
) -> Motion:
    """A motion whose readings are taken of a moving shaft, once each, at 25 C."""
    direction = np.where(speed_deg_s >= 0.0, 1.0, -1.0)
    return Motion(
        protocol=protocol,
        points_per_turn=points,
        repeats=1,
        moving=True,
        time_s=time_s,
        shaft_deg=shaft_deg,
        direction=direction,
        named=direction,
        speed_rpm=speed_deg_s / 6.0,
        turn=turn,
        temperature_c=np.full(len(time_s), 25.0),
    )
