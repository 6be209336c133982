"""Time stamps: running backwards, coarse, jittered, in another unit than seconds."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding, rows_shown
from diagnosis.setup.harmonics import FALSE_ALARM
from diagnosis.setup.record import FEWEST, Record
from diagnosis.setup.relation import travel_deg
from twin.angles import Array, IntArray

_UNITS = {"ms": 1e3, "us": 1e6, "ns": 1e9, "min": 1.0 / 60.0}
"""How many of each a second holds."""
_LONGEST_STEP_S = 1000.0
"""Between two readings of a recording; whole numbers beyond it are smaller units."""
_SHORTEST_STEP_S = 1e-5
"""The loops of the fastest drives read their sensor at 100 kHz."""
_DENSE_S = 0.02
"""Stamps that are closer than this are those of a moving shaft, farther ones may be of stops."""
_LEAST_SCATTER = 0.05
"""Share of a step: what a time printed in tenths of a step scatters by does not count."""
_TIMES = 1.5
"""Even steps must describe the motion so many times better than the stamps do."""


def _stamps(record: Record) -> tuple[Array, Array] | None:
    """Times and travel (m,) of the rows that hold a time; None where there is no clock."""
    time = record.column("time_s")
    if time is None or time.size < 2 * FEWEST or not np.isfinite(time).all() or np.ptp(time) == 0.0:
        return None
    return time, travel_deg(record.reference_deg)


def backwards(record: Record) -> Finding | None:
    """A clock that runs back."""
    found = _stamps(record)
    if found is None:
        return None
    step = np.diff(found[0])
    back = np.flatnonzero(step < 0.0) + 1
    turn = record.column("turn")
    if turn is not None:
        # Each sweep may have a clock of its own.
        back = back[turn[back] == turn[back - 1]]
    if not back.size or back.size > 0.5 * step.size:
        return None
    rows = record.rows(back)
    return Finding(
        kind="time_backwards",
        what="the clock runs backwards",
        evidence=f"at {rows_shown(rows)}; the first by {-step[back[0] - 1]:.4g} s",
        consequence="rows are out of order, or a counter overflows: whatever goes with time is wrong there",
        remedy="sort the rows, or unwrap the counter, and read again",
        rows=rows,
    )


def unit_of_time(record: Record) -> Finding | None:
    """Stamps in another unit than seconds, told by a recorded speed, or by steps no recording has."""
    found = _stamps(record)
    if found is None:
        return None
    time, travel = found
    found_units, evidence = _by_speed(record, time, travel) or _by_length(time) or ((), "")
    if not found_units:
        return None if not evidence else _contradiction(evidence)
    lines = {unit: record.stated(time_s=1.0 / _UNITS[unit]) for unit in found_units}
    alone = len(lines) == 1
    return Finding(
        kind="time_unit",
        what=f"the time is in {' or '.join(lines)}, not in s",
        evidence=evidence,
        consequence="speeds are wrong by that factor: what goes with speed or frequency is missed or misjudged",
        remedy="say the unit"
        + ("" if alone else ": " + "; or ".join(f'for {unit} --columns "{line}"' for unit, line in lines.items())),
        columns=next(iter(lines.values())) if alone else "",
    )


def _by_speed(record: Record, time: Array, travel: Array) -> tuple[tuple[str, ...], str] | None:
    rpm = record.column("speed_rpm")
    if rpm is None:
        return None
    step = np.diff(time)
    moving = (step > 0.0) & (np.abs(rpm[1:]) > 0.0) & np.isfinite(rpm[1:])
    if moving.sum() < FEWEST:
        return None
    by_stamps = np.abs(np.diff(travel))[moving] / step[moving] / 6.0
    way = float(np.sum(by_stamps * step[moving]))
    if way <= 0.0:
        return None
    with np.errstate(over="ignore"):
        ratio = float(np.sum(np.abs(rpm[1:])[moving] * step[moving])) / way
    if not 0.0 < ratio < np.inf:
        return None
    evidence = (
        f"by the stamps the shaft turns at {np.median(by_stamps):.4g} rpm, by speed_rpm at "
        f"{np.median(np.abs(rpm[1:])[moving]):.4g} rpm, {ratio:.4g} times as fast"
    )
    for unit, many in _UNITS.items():
        if abs(np.log(ratio / many)) < np.log(1.5):
            return (unit,), evidence
    # A shaft that stops at each reading turns slower by the stamps; faster than its speed none does.
    return ((), evidence) if ratio < 1.0 / 1.5 else None


def _contradiction(evidence: str) -> Finding:
    return Finding(
        kind="time_unit",
        what="the shaft gets on farther than its speed allows: time_s or speed_rpm is in another unit, or wrong",
        evidence=evidence,
        consequence="what goes with speed or frequency is missed or misjudged",
        remedy="say the units of both, or leave the one that is wrong out",
    )


def _by_length(time: Array) -> tuple[tuple[str, ...], str] | None:
    step = float(np.median(np.diff(time)))
    if abs(step) < _LONGEST_STEP_S or np.any(time % 1.0 != 0.0):
        return None
    seconds = {unit: abs(step) / _UNITS[unit] for unit in ("ms", "us", "ns")}
    may_be = {unit: one for unit, one in seconds.items() if _SHORTEST_STEP_S <= one < _LONGEST_STEP_S} or {
        "ns": seconds["ns"]
    }
    said = " or ".join(f"{one:.4g} s if in {unit}" for unit, one in may_be.items())
    return tuple(may_be), f"whole numbers, {step:.4g} from one reading to the next: {said}"


def jitter_of_time(record: Record) -> Finding | None:
    """Stamps that scatter, or stand still, while the shaft goes on evenly: the readings are even, the stamps not."""
    found = _stamps(record)
    if found is None or np.any(np.diff(found[0]) < 0.0):
        return None
    time, travel = found
    step, moved = np.diff(time), np.diff(travel)
    if step.size < 40 or _one_stamp_a_sweep(record, step):
        return None
    by_stamps, by_rows = _left(moved, step), _left(moved, np.ones_like(step))
    scatter = float(np.std(step) / np.mean(step))
    if (
        scatter < _LEAST_SCATTER
        or by_stamps < _LEAST_SCATTER * np.median(np.abs(moved))
        or not _clearly(by_stamps, by_rows, step.size)
    ):
        return None
    if np.mean(step[step <= np.quantile(step, 0.95)]) > _DENSE_S and not _moving(record):
        return None
    grid = _grid(step)
    coarse = grid is not None and grid > 0.4 * float(np.mean(step))
    at = np.flatnonzero(step == 0.0) + 1
    return Finding(
        kind="time_coarse" if coarse else "time_jitter",
        what="the time stamps are coarse" if coarse else "the time stamps jitter",
        evidence=(f"they come in steps of {grid:.4g} s, " if coarse else "")
        + f"{100.0 * scatter:.0f} % of a step of {np.mean(step):.4g} s; from row to row the shaft goes on evenly to "
        f"{by_rows:.2g} deg, by the stamps to {by_stamps:.2g} deg",
        consequence="what goes with speed, acceleration or frequency is blurred; orders of the turn are not",
        remedy="stamp in the sensor's interrupt with a finer clock, or number the samples and give the period",
        rows=record.rows(at) if coarse else (),
    )


def _one_stamp_a_sweep(record: Record, step: Array) -> bool:
    """Whether the stamp changes with the number of the sweep alone."""
    turn = record.column("turn")
    return turn is not None and not np.any((step != 0.0) & (np.diff(turn) == 0.0))


def _moving(record: Record) -> bool:
    speed = record.column("speed_rpm")
    return speed is not None and bool(np.nanmedian(np.abs(speed)) > 0.0)


def _left(moved: Array, over: Array) -> float:
    """RMS of movement per row (n,) that its steps times the local pace leave, over the moving rows."""
    width = 15
    kernel = np.ones(width)
    many = np.convolve(np.abs(over), kernel, mode="same")
    pace = np.convolve(moved, kernel, mode="same") / np.where(many > 0.0, many, np.inf)
    left = moved - pace * over
    inner = slice(width, -width) if left.size > 3 * width else slice(None)
    scale = np.median(np.abs(left[inner]))
    kept: IntArray = np.flatnonzero(np.abs(left[inner]) <= 8.0 * max(scale, 1e-12))
    return float(np.sqrt(np.mean(left[inner][kept] ** 2))) if kept.size else 0.0


def _clearly(by_stamps: float, by_rows: float, rows: int) -> bool:
    from scipy.stats import f

    ratio = (by_stamps / max(by_rows, 1e-12)) ** 2
    return ratio > _TIMES**2 and bool(f.sf(ratio, rows // 2, rows // 2) < FALSE_ALARM)


def _grid(step: Array) -> float | None:
    """The smallest step of the clock, where all steps are multiples of it."""
    positive = step[step > 0.0]
    if not positive.size:
        return None
    least = float(np.min(positive))
    many = positive / least
    return least if np.all(np.abs(many - np.round(many)) < 0.02) else None
