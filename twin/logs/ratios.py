"""An angle that turns several times in a turn of the other: electrical degrees, or a gear between the two."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from twin.angles import Array, wrap_deg
from twin.logs.angles import AngleUnit, drifts, options_of, preferred, rounding_deg, same_angle
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
_LARGEST_STEP_DEG, _LARGEST_STEP_OF_COUNTS_DEG = 150.0, 30.0
"""Typical step from row to row up to which an angle is followed over its turns; up to which counts show their turn."""
_CLEARLY, _ALIKE_DEG = 1.5, 0.1
"""A unit is clearly meant where of another's steps so many times as large a part is off, and this much more."""
_FEW_COUNTS = 4
"""Numbers of counts a turn up to which a column is taken to show its own."""


@dataclass(frozen=True)
class Turned:
    """The units of a reference and a sensor, and how often either turns in a turn of the shaft; one of both is 1.

    ``off_deg`` is how far steps of the faster one are off those that the slower one lets expect, ``step_deg`` how long
    these are in the mean: a wrong unit scales both.
    """

    units: tuple[AngleUnit, AngleUnit]
    times: tuple[float, float]
    off_deg: float
    step_deg: float

    def is_one_sensors(self, reference: Array, measured: Array) -> bool:
        """Whether what one angle (n,) differs by from the other, both as logged, is what is rounded off both."""
        known = np.isfinite(reference) & np.isfinite(measured)
        made = [
            (unwrapped_deg(unit.degrees(values[known])) / times, rounding_deg(values[known], unit) / times)
            for values, unit, times in zip((reference, measured), self.units, self.times, strict=True)
        ]
        (a, off_a), (b, off_b) = made
        return bool(min(np.ptp(b - a), np.ptp(b + a)) <= 2.0 * (off_a + off_b))

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
    found: dict[tuple[AngleUnit, AngleUnit], Turned] = {}
    for pair in itertools.product(options[0], options[1]):
        one = _turned((reference[known], measured[known]), pair)
        found |= {pair: one} if one is not None else {}
    kept = [found[pair] for pair in preferred(list(found))]
    least = min((one.off_deg / one.step_deg for one in kept), default=0.0)
    return [one for one in kept if one.off_deg <= _CLEARLY * least * one.step_deg + _ALIKE_DEG]


def _turned(values: tuple[Array, Array], units: tuple[AngleUnit, AngleUnit]) -> Turned | None:
    """How often each of two angles (n,) turns in a turn of the slower; None where that is no whole number from 2."""
    wrapped = [unit.degrees(one) for one, unit in zip(values, units, strict=True)]
    if not all(_can_be_followed(one, unit) for one, unit in zip(wrapped, units, strict=True)):
        return None
    a, b = (unwrapped_deg(one) for one in wrapped)
    first_is_slow = bool(np.ptp(a) <= np.ptp(b))
    slow, fast = (a, b) if first_is_slow else (b, a)
    if np.ptp(slow) < 360.0 * _LEAST_TURNS:
        return None
    slope = float(np.polyfit(slow - np.mean(slow), fast, 1)[0])
    times = float(np.round(abs(slope)))
    if not 2.0 <= times <= MOST_TIMES or abs(abs(slope) - times) > min(_WHOLE, _WHOLE_SHARE * times):
        return None
    expected = times * np.sign(slope) * np.diff(slow)
    off = float(np.quantile(np.abs(np.diff(fast) - expected), 0.98))
    # Steps that are now and then much smaller or larger: it wraps at no turn.
    stumbles = off > _UNEVEN * float(np.median(np.abs(expected))) + _NOISE_DEG
    if stumbles or not same_angle(fast / times, slow) or drifts(slow, fast / times):
        return None
    return Turned(units, (1.0, times) if first_is_slow else (times, 1.0), off, float(np.mean(np.abs(expected))))


def _can_be_followed(angle_deg: Array, unit: AngleUnit) -> bool:
    """Whether an angle (n,) moves by little enough from row to row; nine tenths of its steps are judged."""
    steps = np.abs(np.diff(angle_deg))
    typical = float(np.quantile(np.abs(wrap_deg(steps)), 0.9))
    largest = _LARGEST_STEP_OF_COUNTS_DEG if unit.counts else _LARGEST_STEP_DEG
    return typical <= largest and float(np.max(steps)) <= _TURN_DEG
