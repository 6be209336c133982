"""An angle that turns several times in a turn of the other: electrical degrees, or a gear between the two."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from twin.angles import Array, wrap_deg
from twin.logs.angles import AngleUnit, drifts, options_of, preferred, same_angle
from twin.logs.names import Meaning
from twin.logs.statement import Column, unwrapped_deg

MOST_TIMES = 64
"""Pole pairs and whole ratios of gears up to this are tried."""
_LEAST_TURNS = 0.9
"""Turns of the slower angle from which how often the faster one turns can be told: errors repeat with the turn."""
_WHOLE_SHARE, _WHOLE = 0.015, 0.4
"""How far from a whole number a ratio may be measured, as a share of it: order 1 of 3 deg tilts a turn by that."""
_TURN_DEG = 360.5
"""The largest step from row to row, where an angle begins anew; numbers that leap farther are in another unit."""
_UNEVEN, _NOISE_DEG = 0.25, 3.0
"""Share of a step, and angle beside it, by which steps may differ from those expected."""
_LARGEST_STEP_DEG = 150.0
"""Typical step from row to row up to which an angle is followed over its turns."""
_FEW_COUNTS = 4
"""Numbers of counts a turn up to which a column is taken to show its own."""


@dataclass(frozen=True)
class Turned:
    """The units of a reference and a sensor, and how often either turns in a turn of the shaft; one of both is 1."""

    units: tuple[AngleUnit, AngleUnit]
    times: tuple[float, float]

    def columns(self, sources: tuple[str, str]) -> tuple[Column, Column]:
        """The statement, with the faster one followed over its turns and divided."""
        made = [
            replace(unit.column(target, source), per=None if times == 1.0 else times)
            for unit, target, source, times in zip(
                self.units, ("reference_deg", "measured_deg"), sources, self.times, strict=True
            )
        ]
        return made[0], made[1]


def turned(reference: Array, measured: Array, *, said: tuple[Meaning, Meaning]) -> list[Turned]:
    """In which units two angles (n,) follow each other where one turns a whole number of times faster; often none."""
    known = np.isfinite(reference) & np.isfinite(measured)
    if known.sum() < 8:
        return []
    options = [
        [unit for unit in units if not unit.counts or len(units) <= _FEW_COUNTS]
        for units in (options_of(values[known], one) for values, one in zip((reference, measured), said, strict=True))
    ]
    pairs = [(a, b) for a in options[0] for b in options[1]]
    found = {pair: _times(pair[0].degrees(reference[known]), pair[1].degrees(measured[known])) for pair in pairs}
    fitting = preferred([pair for pair, times in found.items() if times is not None])
    return [Turned(pair, times) for pair in fitting if (times := found[pair]) is not None]


def _times(reference_deg: Array, measured_deg: Array) -> tuple[float, float] | None:
    """How often each of two angles (n,) turns in a turn of the slower; None where that is no whole number from 2."""
    both = (reference_deg, measured_deg)
    if any(_typical_step(one) > _LARGEST_STEP_DEG or np.max(np.abs(np.diff(one))) > _TURN_DEG for one in both):
        return None
    a, b = unwrapped_deg(reference_deg), unwrapped_deg(measured_deg)
    span = float(np.ptp(a)), float(np.ptp(b))
    if min(span) < 360.0 * _LEAST_TURNS:
        return None
    slow, fast = (a, b) if span[0] <= span[1] else (b, a)
    slope = float(np.polyfit(slow - np.mean(slow), fast, 1)[0])
    times = float(np.round(abs(slope)))
    if not 2.0 <= times <= MOST_TIMES or abs(abs(slope) - times) > min(_WHOLE, _WHOLE_SHARE * times):
        return None
    if (
        not same_angle(fast / times, slow)
        or drifts(slow, fast / times)
        or _stumbles(slow * np.sign(slope), fast, times)
    ):
        return None
    return (1.0, times) if span[0] <= span[1] else (times, 1.0)


def _typical_step(angle_deg: Array) -> float:
    """Nine tenths of the steps (n - 1,) are smaller."""
    return float(np.quantile(np.abs(wrap_deg(np.diff(angle_deg))), 0.9))


def _stumbles(slow_deg: Array, fast_deg: Array, times: float) -> bool:
    """Whether the faster angle (n,) moves now and then by much less or more, as where it wraps at no turn."""
    steps, expected = np.diff(fast_deg), times * np.diff(slow_deg)
    off = float(np.quantile(np.abs(steps - expected), 0.98))
    return off > _UNEVEN * float(np.median(np.abs(expected))) + _NOISE_DEG
