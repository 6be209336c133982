"""The menu of further measurements: what the bench would have to record, planned on the motion of the present sweep.

Most entries extend the present protocol; the extended one is to be measured as a whole and explained anew. Two of them
are a further recording of the same device, which is explained together with the present one. The order of the costs is
the project's own judgement: first what needs a column more, then what needs time, then what needs another drive, an
oven, or a change of the mechanics.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from twin.air_gap import ratios_of
from twin.angles import TAU, Array, IntArray
from twin.effect import Effect
from twin.magnet.assembly import Assembly
from twin.motion import RPM, Motion
from twin.recordings import Setup

FINEST_DEG = (0.05, 1.0)
FINE_DEG = (0.5, 20.0)
"""Spacing after a reversal, and how far it reaches: a play is taken up in tenths of a degree, a memory in tens."""
REVERSALS = 8
_LEG_DEG = 120.0
MORE = 3
OTHER_TEMPERATURE_K = 40.0
FIRST_SPEED_RPM = 300.0
GAP_FACTOR = 2.0
TURNED_DEG = 90.0
"""Turns an error of order 1 by a quarter of its period and one of order 2 by half."""


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """An entry of the menu.

    ``words`` say what to do, with ``{near:g}`` and ``{far:g}`` for air gaps [mm]; ``cost`` is its rank. ``brings``
    is what it gives a motion that has it not yet, as in :attr:`~twin.Motion.provides`. Either ``extended`` makes of a
    recording's motion the one to be measured in its place, or None where there is nothing to extend; or ``elsewhere``
    makes of how the bench was set up how it is to be set up for a further recording, which tells only of effects that
    are ``moved`` by it.
    """

    name: str
    words: str
    cost: int
    brings: str = ""
    extended: Callable[[Motion], Motion | None] | None = None
    elsewhere: Callable[[Setup, Assembly], Setup] | None = None
    moved: Callable[[Effect], bool] | None = None

    def in_words(self, planned: Motion) -> str:
        """What to do, where this is the planned motion."""
        gap_mm = None if planned.recordings is None else planned.recordings.setups[-1].air_gap_mm
        return self.words if gap_mm is None else self.words.format(near=gap_mm / GAP_FACTOR, far=gap_mm)

    def plan(self, motion: Motion, assembly: Assembly | None = None) -> Motion | None:
        """The motion to be measured; None where the present one brings as much already.

        ``assembly`` is the magnet at the air gap of the present sweep.
        """
        if self.brings in motion.provides:
            return None
        if self.elsewhere is not None:
            return _with_another(motion, self.elsewhere, assembly or Assembly())
        assert self.extended is not None
        parts = [self.extended(part) for part in motion.parts]
        if all(part is None for part in parts):
            return None
        longer = [own if part is None else part for part, own in zip(parts, motion.parts, strict=True)]
        return longer[0] if motion.recordings is None else Motion.joined(longer, motion.recordings.setups)


def _with_another(motion: Motion, elsewhere: Callable[[Setup, Assembly], Setup], assembly: Assembly) -> Motion:
    """The recordings as they are, and the first of them once more with the bench set up otherwise."""
    recordings, first = motion.recordings, motion.parts[0]
    here = Setup(air_gap_mm=float(assembly.placement.air_gap_mm))
    setups = (here,) if recordings is None else recordings.setups
    return Motion.joined([*motion.parts, first], [*setups, elsewhere(setups[0], assembly)])


def _time_stamps(motion: Motion) -> Motion:
    """The sweep twice with the clock running, as long a pause between them as the sweep itself takes."""
    pause_s = float(np.ptp(motion.time_s))
    return _joined(motion, _again(motion, pause_s=pause_s), also="time_s")


def _channels(motion: Motion) -> Motion:
    return replace(motion, columns=motion.columns | {"vx"})


def _more_turns(motion: Motion) -> Motion:
    longer, rows = motion, len(motion)
    for _ in range(MORE):
        longer = _joined(longer, _again(longer, rows=rows))
    return longer


def _other_direction(motion: Motion) -> Motion:
    """The way back over the same angles, at the same pace."""
    back = replace(
        motion,
        shaft_rad=motion.shaft_rad[::-1],
        time_s=_follow(motion, motion.time_s[-1] - motion.time_s[::-1]),
        direction=-motion.direction[::-1],
        speed_rad_s=-motion.speed_rad_s[::-1],
        turn=_later(motion, motion.turn.max(initial=0) - motion.turn[::-1]),
        temperature_c=motion.temperature_c[::-1],
        current_a=motion.current_a[::-1],
    )
    return _joined(motion, back, also="direction")


def _after_reversals(motion: Motion) -> Motion | None:
    """Legs of a third of a turn to and fro, each begun in fine steps; for a shaft that stops at each reading."""
    if "both directions" not in motion.provides or "moving shaft" in motion.provides:
        return None
    coarse, start, leg = TAU / motion.points_per_turn, 0.0, []
    for step_deg, reach_deg in (FINEST_DEG, FINE_DEG, (360.0, _LEG_DEG)):
        step, reach = min(np.radians(step_deg), coarse), np.radians(reach_deg)
        leg.append(np.arange(start + step, reach + 0.5 * step, step))
        start = float(leg[-1][-1])
    travel_rad = np.concatenate(leg)
    way, place, shaft, ways = -motion.direction[-1], motion.shaft_rad[-1], [], []
    for _ in range(REVERSALS):
        shaft.append(place + way * travel_rad)
        ways.append(np.full(travel_rad.size, way))
        place, way = shaft[-1][-1], -way
    path, direction = np.concatenate(shaft), np.concatenate(ways)
    extra = replace(
        motion,
        shaft_rad=path,
        time_s=_follow(motion, np.median(np.diff(motion.time_s)) * np.arange(path.size)),
        direction=direction,
        speed_rad_s=np.zeros(path.size),
        turn=_later(motion, np.zeros(path.size, dtype=np.int64)),
        temperature_c=np.full(path.size, motion.temperature_c[-1]),
        current_a=np.full(path.size, motion.current_a[-1]),
    )
    return _joined(motion, extra, also="direction")


def _second_speed(motion: Motion) -> Motion:
    """The sweep again at twice its speed; in motion, where the shaft stood still at each reading."""
    again = _again(motion)
    if np.any(motion.speed_rad_s != 0.0):
        speed = 2.0 * again.speed_rad_s
        elapsed = 0.5 * (again.time_s - again.time_s[0])
    else:
        pace = FIRST_SPEED_RPM * RPM
        speed = pace * again.direction
        step = np.abs(np.diff(again.shaft_rad))
        # A shaft that turns round in its place takes its time too.
        step[step == 0.0] = np.median(step)
        elapsed = np.concatenate([[0.0], np.cumsum(step)]) / pace
    faster = replace(again, speed_rad_s=speed, time_s=again.time_s[0] + elapsed)
    return _joined(motion, faster, also="speed_rpm")


def _second_temperature(motion: Motion) -> Motion:
    again = _again(motion)
    warmer = replace(again, temperature_c=again.temperature_c + OTHER_TEMPERATURE_K)
    return _joined(motion, warmer, also="temperature_c")


def _farther(first: Setup, assembly: Assembly) -> Setup:
    """At twice the air gap of the first recording."""
    here = _at(assembly, float(assembly.placement.air_gap_mm) if first.air_gap_mm is None else first.air_gap_mm)
    there = _at(assembly, GAP_FACTOR * float(here.placement.air_gap_mm))
    ratios = ratios_of(there, here)
    return replace(
        first,
        air_gap_mm=float(there.placement.air_gap_mm),
        field=first.field * float(ratios["field_ratio"]),
        distance=first.distance * float(ratios["distance_ratio"]),
    )


def _at(assembly: Assembly, air_gap_mm: float) -> Assembly:
    return replace(assembly, placement=replace(assembly.placement, air_gap_mm=air_gap_mm))


def _turned(first: Setup, assembly: Assembly) -> Setup:
    """With the sensor turned about the shaft."""
    return replace(first, turned_deg=first.turned_deg + TURNED_DEG)


def _follows_field(effect: Effect) -> bool:
    """Whether it changes with the magnet's field or its distance."""
    return bool(effect.follow_field) or effect.at_magnet is not None


def _stays_with_bench(effect: Effect) -> bool:
    """Whether it stays where it is when the sensor is turned on the shaft."""
    return any(effect.owner(name) == "bench" for name in effect.params)


MENU = (
    Measurement(
        name="time stamps",
        words="record the sweep twice, with time_s",
        cost=1,
        brings="time_s",
        extended=_time_stamps,
    ),
    Measurement(name="raw channels", words="record vx and vy", cost=2, brings="vx", extended=_channels),
    Measurement(name="more turns", words="repeat the whole sweep three times", cost=3, extended=_more_turns),
    Measurement(
        name="other direction",
        words="measure on the way back too",
        cost=4,
        brings="both directions",
        extended=_other_direction,
    ),
    Measurement(
        name="denser points after a reversal",
        words=f"sample every {FINEST_DEG[0]:g} deg for {FINEST_DEG[1]:g} deg, then every {FINE_DEG[0]:g} deg up to "
        f"{FINE_DEG[1]:g} deg, after {REVERSALS} further reversals",
        cost=5,
        extended=_after_reversals,
    ),
    Measurement(
        name="second speed",
        words="measure at a second speed",
        cost=6,
        brings="two speeds",
        extended=_second_speed,
    ),
    Measurement(
        name="second temperature",
        words=f"measure at a second temperature, {OTHER_TEMPERATURE_K:g} K away",
        cost=7,
        brings="two temperatures",
        extended=_second_temperature,
    ),
    Measurement(
        name="second mounting",
        words=f"turn the sensor by {TURNED_DEG:g} deg on the shaft, nothing else, record the sweep again and explain "
        f"both together (--mounting 0,{TURNED_DEG:g})",
        cost=8,
        brings="two mountings",
        elsewhere=_turned,
        moved=_stays_with_bench,
    ),
    Measurement(
        name="second air gap",
        words="record the sweep again at twice the air gap ({far:g} mm for {near:g} mm) and explain both together "
        "(--air-gap {near:g},{far:g})",
        cost=9,
        brings="two air gaps",
        elsewhere=_farther,
        moved=_follows_field,
    ),
)
"""Cheapest first."""


# ---- joining motions ----------------------------------------------------------------------------------------------


def _follow(motion: Motion, elapsed_s: Array, pause_s: float = 0.0) -> Array:
    """Times [s] that begin a reading after the motion's last, and a pause."""
    step = float(np.median(np.diff(motion.time_s))) if len(motion) > 1 else 1.0
    return np.asarray(motion.time_s[-1] + step + pause_s + elapsed_s)


def _later(motion: Motion, turn: IntArray) -> IntArray:
    """Numbers of further turns; without a turn column there are none."""
    return turn + motion.turn.max(initial=0) + 1 if "turn" in motion.columns else np.zeros_like(turn)


def _again(motion: Motion, *, rows: int | None = None, pause_s: float = 0.0) -> Motion:
    """The sweep's last ``rows`` (all) once more, beginning a step from where the shaft stands."""
    part = slice(len(motion) - (rows or len(motion)), None)
    shaft, direction = motion.shaft_rad[part], motion.direction[part]
    step = float(np.median(np.abs(np.diff(shaft)))) if shaft.size > 1 else 0.0
    return replace(
        motion,
        shaft_rad=shaft + (motion.shaft_rad[-1] - shaft[0] + step * direction[0]),
        time_s=_follow(motion, motion.time_s[part] - motion.time_s[part][0], pause_s),
        direction=direction,
        speed_rad_s=motion.speed_rad_s[part],
        turn=_later(motion, motion.turn[part] - motion.turn[part].min(initial=0)),
        temperature_c=motion.temperature_c[part],
        current_a=motion.current_a[part],
    )


def _joined(first: Motion, then: Motion, *, also: str | None = None) -> Motion:
    """One motion after the other, with one more recorded column."""
    columns = first.columns | ({also} if also else frozenset())
    return Motion(
        shaft_rad=np.concatenate([first.shaft_rad, then.shaft_rad]),
        time_s=np.concatenate([first.time_s, then.time_s]),
        direction=np.concatenate([first.direction, then.direction]),
        speed_rad_s=np.concatenate([first.speed_rad_s, then.speed_rad_s]),
        turn=np.concatenate([first.turn, then.turn]),
        temperature_c=np.concatenate([first.temperature_c, then.temperature_c]),
        columns=columns,
        current_a=np.concatenate([first.current_a, then.current_a]),
    )
