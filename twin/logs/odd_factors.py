"""Counts a turn that no encoder of the list has, and gears of no whole ratio: the factor that values fit, roughly."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from twin.angles import Array
from twin.logs.angles import AngleUnit, options_of
from twin.logs.names import Meaning
from twin.logs.restarts import restarts
from twin.logs.statement import Column, Term, unwrapped_deg

_LEAST_TURN_DEG = 324.0
_LEFT_DEG = 5.0
"""Scatter about a straight line that errors of an angle may have; what is no angle scatters by a part of its span."""
_DIGITS = 4


@dataclass(frozen=True)
class OddFactor:
    """Two columns and the statement that fits; ``said`` is what is odd, about the column at ``place`` of the two."""

    columns: tuple[Column, Column]
    said: str
    place: int


def odd_factor(
    values: tuple[Array, Array], *, said: tuple[Meaning, Meaning], sources: tuple[str, str]
) -> OddFactor | None:
    """A factor by which a reference and a sensor (n,) follow each other, one of them in a unit that is known.

    ``sources`` are what the columns are called by. None where there is no such factor.
    """
    known = np.isfinite(values[0]) & np.isfinite(values[1])
    if known.sum() < 8:
        return None
    targets = ("reference_deg", "measured_deg")
    for place in (0, 1):
        other = 1 - place
        for unit in _named(values[other][known], said[other]):
            angle = unwrapped_deg(unit.degrees(values[other][known]))
            own = said[place].unit
            numbers = (
                values[place][known]
                if own is None
                else unwrapped_deg(AngleUnit(own.name).degrees(values[place][known]))
            )
            a_turn = _a_turn(angle, numbers)
            if a_turn is None or (own is not None and a_turn < 360.0):
                continue
            columns = [unit.column(targets[other], sources[other])] * 2
            if own is None:
                columns[place] = Column(targets[place], Term(sources[place], (("*", 360.0), ("/", a_turn))))
                odd = f"values fit about {a_turn:g} counts a turn, which no encoder of the list has"
            else:
                times = float(f"{a_turn / 360.0:.{_DIGITS}g}")
                columns[place] = replace(AngleUnit(own.name).column(targets[place], sources[place]), per=times)
                odd = f"turns about {times:g} times in a turn of the other, which is no whole number"
            return OddFactor((columns[0], columns[1]), odd, place)
    return None


def _named(values: Array, said: Meaning) -> list[AngleUnit]:
    """The units that a column (n,) names, or shows by where it begins anew."""
    if said.unit is not None:
        return [AngleUnit(said.unit.name)]
    wraps = bool(np.any(restarts(values)))
    return [unit for unit in options_of(values, said) if unit.name] if wraps else []


def _a_turn(angle_deg: Array, numbers: Array) -> float | None:
    """By how much numbers (n,) go on in a turn of an angle, to four digits; None where they do not follow it."""
    begins_anew = np.any(restarts(numbers))
    if np.ptp(angle_deg) < _LEAST_TURN_DEG or np.ptp(numbers) == 0.0 or begins_anew:
        return None
    slope, at_zero = np.polyfit(angle_deg, numbers, 1)
    left_deg = float(np.std(numbers - slope * angle_deg - at_zero)) / abs(slope) if slope else np.inf
    return float(f"{abs(slope) * 360.0:.{_DIGITS}g}") if left_deg <= _LEFT_DEG else None
