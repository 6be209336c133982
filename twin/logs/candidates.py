"""Pairs of a log's columns that follow each other as a reference and a sensor do, and what speaks against one."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from twin.logs.angles import Pair, is_copy, is_one_sensors, units_of_pair
from twin.logs.names import Meaning
from twin.logs.row_counters import counts_rows
from twin.logs.statement import Column
from twin.logs.table import Table

_NAMED_BOTH = 2
"""What two names weigh that tell a reference and a sensor."""


@dataclass(frozen=True)
class Candidate:
    """Two columns as reference and sensor, the units that fit, how much their names speak for it, and what against."""

    reference: int
    measured: int
    units: Pair
    weight: int
    doubt: str = ""

    def columns(self, table: Table) -> tuple[Column, Column]:
        """The reference and the sensor as a statement says them."""
        sources = table.sources
        return (
            self.units[0].column("reference_deg", sources[self.reference]),
            self.units[1].column("measured_deg", sources[self.measured]),
        )


def candidates_of(table: Table, said: tuple[Meaning, ...], angles: list[int]) -> list[Candidate]:
    """Ordered pairs of columns that follow each other in some units: those for which the most speaks in the names.

    A pair is in doubt where one column holds the other's angle once more and no names tell a reference from a sensor,
    or where its counts may be those of the rows: such are given only where there is no other.
    """
    weighed = [(weight_of(said[a], said[b]), a, b) for a, b in itertools.permutations(angles, 2)]
    doubtful: list[Candidate] = []
    copies: list[Candidate] = []
    for weight in sorted({weight for weight, _, _ in weighed if weight >= 0}, reverse=True):
        found: list[Candidate] = []
        for _, reference, measured in (one for one in weighed if one[0] == weight):
            a, b = table.values[reference], table.values[measured]
            if np.array_equal(a, b, equal_nan=True):
                continue
            fitting = [
                Candidate(reference, measured, units, weight)
                for units in units_of_pair(a, b, said=(said[reference], said[measured]))
            ]
            copied = any(is_one_sensors(a, b, one.units) for one in fitting)
            for one in fitting:
                doubt = _doubt(table, said, one, copied=copied)
                (doubtful if doubt else copies if copied else found).append(replace(one, doubt=doubt))
        if found:
            return list(_each_once(found, table))
    kept = copies or doubtful
    return [one for one in kept if one.weight == kept[0].weight and one.doubt == kept[0].doubt]


def _doubt(table: Table, said: tuple[Meaning, ...], one: Candidate, *, copied: bool) -> str:
    """Why a pair is hardly a reference and a sensor; empty where nothing speaks against it."""
    a, b = (table.names[k] or table.sources[k] for k in (one.reference, one.measured))
    for name, k, unit in zip((a, b), (one.reference, one.measured), one.units, strict=True):
        if unit.counts and counts_rows(table.values[k], said[k]):
            step = float(np.median(np.diff(table.values[k])))
            return f"{name} goes on by {step:g} in each row, as a counter does, or a shaft that is stepped"
    if copied and one.weight < _NAMED_BOTH:
        return f"{a} and {b} hold one angle to the last digit, as those of one sensor do, or two that agree so well"
    swapped = weight_of(said[one.measured], said[one.reference])
    if not said[one.reference].reference and one.weight != swapped:
        return f"{a} and {b} follow each other, and neither name is that of a reference: both may be of one sensor"
    return ""


def _each_once(found: Sequence[Candidate], table: Table) -> Iterator[Candidate]:
    """Pairs without those that differ from an earlier one only by columns which hold the same angles."""

    def alike(one: Candidate, other: Candidate) -> bool:
        sides = ((one.reference, other.reference), (one.measured, other.measured))
        return any(a != b for a, b in sides) and all(
            a == b or is_copy(table.values[a], table.values[b], (one.units[side], other.units[side]))
            for side, (a, b) in enumerate(sides)
        )

    kept: list[Candidate] = []
    for one in found:
        if not any(alike(one, other) for other in kept):
            kept.append(one)
            yield one


def weight_of(reference: Meaning, measured: Meaning) -> int:
    """How much two names speak for a reference and a sensor, in this order."""
    return reference.reference - reference.sensor + measured.sensor - measured.reference
