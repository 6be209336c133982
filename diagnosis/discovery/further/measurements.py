"""The menu of further measurements: what the bench would have to record, planned on the motion of the present sweep.

Each entry extends the present protocol; the extended one is to be measured as a whole and explained anew. The order of
the costs is the project's own judgement: first what needs a column more, then what needs time, then what needs another
drive, an oven, or a change of the mechanics.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from twin.angles import TAU, Array, IntArray
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.motion import RPM, Motion

FINEST_DEG = (0.05, 1.0)
FINE_DEG = (0.5, 20.0)
"""Spacing after a reversal, and how far it reaches: a play is taken up in tenths of a degree, a memory in tens."""
REVERSALS = 8
_LEG_DEG = 120.0
MORE = 3
OTHER_TEMPERATURE_K = 40.0
FIRST_SPEED_RPM = 300.0
GAP_FACTOR = 2.0


@dataclass(frozen=True, kw_only=True)
class Recording:
    """One planned recording: motion, whether the channels are recorded, and the magnet's distance.

    ``field`` is the magnet's field at the sensor against the present one, ``distance`` that from its centre.
    """

    motion: Motion
    channels: bool
    field: float = 1.0
    distance: float = 1.0


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """An entry of the menu: what to do in plain words, its rank by cost, and how it is planned.

    ``plan`` takes the present motion and gives the recordings; None where the sweep has that already.
    """

    name: str
    words: str
    cost: int
    plan: Callable[[Motion], tuple[Recording, ...] | None]


def _once(motion: Motion, *, channels: bool | None = None) -> tuple[Recording, ...]:
    return (Recording(motion=motion, channels="vx" in motion.columns if channels is None else channels),)


def _time_stamps(motion: Motion) -> tuple[Recording, ...] | None:
    """The sweep twice with the clock running, as long a pause between them as the sweep itself takes."""
    if "time_s" in motion.columns:
        return None
    pause_s = float(np.ptp(motion.time_s))
    return _once(_joined(motion, _again(motion, pause_s=pause_s), also="time_s"))


def _channels(motion: Motion) -> tuple[Recording, ...] | None:
    if "vx" in motion.columns:
        return None
    return _once(replace(motion, columns=motion.columns | {"vx"}), channels=True)


def _more_turns(motion: Motion) -> tuple[Recording, ...] | None:
    longer, rows = motion, len(motion)
    for _ in range(MORE):
        longer = _joined(longer, _again(longer, rows=rows))
    return _once(longer)


def _other_direction(motion: Motion) -> tuple[Recording, ...] | None:
    """The way back over the same angles, at the same pace."""
    if "both directions" in motion.provides:
        return None
    back = replace(
        motion,
        shaft_rad=motion.shaft_rad[::-1],
        time_s=_follow(motion, motion.time_s[-1] - motion.time_s[::-1]),
        direction=-motion.direction[::-1],
        speed_rad_s=-motion.speed_rad_s[::-1],
        turn=_later(motion, motion.turn.max(initial=0) - motion.turn[::-1]),
        temperature_c=motion.temperature_c[::-1],
    )
    return _once(_joined(motion, back, also="direction"))


def _after_reversals(motion: Motion) -> tuple[Recording, ...] | None:
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
    )
    return _once(_joined(motion, extra, also="direction"))


def _second_speed(motion: Motion) -> tuple[Recording, ...] | None:
    """The sweep again at twice its speed; in motion, where the shaft stood still at each reading."""
    if "two speeds" in motion.provides:
        return None
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
    return _once(_joined(motion, faster, also="speed_rpm"))


def _second_temperature(motion: Motion) -> tuple[Recording, ...] | None:
    if "two temperatures" in motion.provides:
        return None
    again = _again(motion)
    warmer = replace(again, temperature_c=again.temperature_c + OTHER_TEMPERATURE_K)
    return _once(_joined(motion, warmer, also="temperature_c"))


def _second_air_gap(motion: Motion) -> tuple[Recording, ...] | None:
    """The sweep once more at twice the air gap, which weakens the field as that of a typical magnet."""
    magnet, near = Magnet(), float(Placement().air_gap_mm)
    height, far = float(magnet.height_mm), GAP_FACTOR * near
    here = _once(motion)[0]
    field = _on_axis(magnet, far) / _on_axis(magnet, near)
    return here, replace(here, field=field, distance=(far + 0.5 * height) / (near + 0.5 * height))


def _on_axis(magnet: Magnet, gap_mm: float) -> float:
    """Field of a diametral cylinder on its axis, up to a constant factor: half of an axial one's, turned round.

    Outside the body the demagnetising factors sum to zero; for the axial cylinder: Griffiths, Introduction to
    Electrodynamics, problem 6.9 with example 5.6.
    """
    radius, height = 0.5 * float(magnet.diameter_mm), float(magnet.height_mm)
    near, far = gap_mm / np.hypot(gap_mm, radius), (gap_mm + height) / np.hypot(gap_mm + height, radius)
    return float(far - near)


MENU = (
    Measurement(name="time stamps", words="record the sweep twice, with time_s", cost=1, plan=_time_stamps),
    Measurement(name="raw channels", words="record vx and vy", cost=2, plan=_channels),
    Measurement(name="more turns", words="repeat the whole sweep three times", cost=3, plan=_more_turns),
    Measurement(name="other direction", words="measure on the way back too", cost=4, plan=_other_direction),
    Measurement(
        name="denser points after a reversal",
        words=f"sample every {FINEST_DEG[0]:g} deg for {FINEST_DEG[1]:g} deg, then every {FINE_DEG[0]:g} deg up to "
        f"{FINE_DEG[1]:g} deg, after {REVERSALS} further reversals",
        cost=5,
        plan=_after_reversals,
    ),
    Measurement(name="second speed", words="measure at a second speed", cost=6, plan=_second_speed),
    Measurement(
        name="second temperature",
        words=f"measure at a second temperature, {OTHER_TEMPERATURE_K:g} K away",
        cost=7,
        plan=_second_temperature,
    ),
    Measurement(name="second air gap", words="measure at a second air gap", cost=8, plan=_second_air_gap),
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
    )
