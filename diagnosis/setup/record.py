"""What the set-up is checked on: the columns of a recording as they are, whether they make a sweep or not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np

from diagnosis.setup.relation import Relation, relation_of
from twin.angles import Array, IntArray
from twin.logs.statement import Column, Term, text_of
from twin.sweep import Sweep

FEWEST = 8
"""Readings of both angles below which nothing is asked about them."""


@dataclass(frozen=True, eq=False)
class Record:
    """Columns of a recording by the names of a sweep's, each (n,), NaN where a cell is missing.

    ``numbers`` (n,) are those of its rows, the first reading being 1. ``statement`` is how they come from the columns
    of the log; empty: they bear these names there.
    """

    name: str
    columns: Mapping[str, Array]
    numbers: IntArray
    statement: tuple[Column, ...] = field(default=())

    @classmethod
    def of(cls, sweep: Sweep) -> Self:
        """The record that a sweep is."""
        return cls(sweep.name, sweep.columns, sweep.numbers)

    @cached_property
    def both(self) -> IntArray:
        """Places (m,) of the rows that hold both angles."""
        if not {"reference_deg", "measured_deg"} <= set(self.columns):
            return np.zeros(0, dtype=np.int64)
        return np.flatnonzero(np.isfinite(self.columns["reference_deg"]) & np.isfinite(self.columns["measured_deg"]))

    @property
    def reference_deg(self) -> Array:
        """Reference of the rows that hold both angles (m,)."""
        return self._both("reference_deg")

    @property
    def measured_deg(self) -> Array:
        """Reading of the rows that hold both angles (m,)."""
        return self._both("measured_deg")

    @property
    def angles(self) -> tuple[Array, Array]:
        """Both angles (m,) of the rows that hold both."""
        return self.reference_deg, self.measured_deg

    def column(self, name: str) -> Array | None:
        """Another column (m,) of the rows that hold both angles; None where there is none."""
        return self._both(name) if name in self.columns else None

    def rows(self, places: IntArray) -> tuple[int, ...]:
        """Numbers of rows, by their places among those that hold both angles."""
        return tuple(int(row) for row in self.numbers[self.both[places]])

    @cached_property
    def relation(self) -> Relation | None:
        """How the reading goes with the reference; None where it does not."""
        return relation_of(self.reference_deg, self.measured_deg) if self.both.size >= FEWEST else None

    def stated(self, **factors: float) -> str:
        """The statement that reads the log with some columns multiplied."""
        return text_of(tuple(_scaled(one, factors.get(one.target, 1.0)) for one in self._own))

    def exchanged(self, one: str, other: str) -> str:
        """The statement that reads the log with two columns exchanged."""
        swap = {one: other, other: one}
        return text_of(tuple(replace(column, target=swap.get(column.target, column.target)) for column in self._own))

    def turned(self, **times: float) -> str:
        """The statement that follows some angles over their turns, and divides them by how often each turns."""
        return text_of(tuple(replace(one, per=times[one.target]) if one.target in times else one for one in self._own))

    @property
    def _own(self) -> tuple[Column, ...]:
        return self.statement or tuple(Column(name, Term(name)) for name in self.columns)

    def _both(self, name: str) -> Array:
        return np.asarray(self.columns[name][self.both]) if self.both.size else np.zeros(0)


def _scaled(column: Column, factor: float) -> Column:
    """A column multiplied by a factor, with its addend; what is made of two columns cannot be multiplied so."""
    if factor == 1.0 or column.across is not None or column.plus is not None:
        return column
    if column.per is not None and factor > 0.0:
        return replace(column, per=column.per / factor)
    factors = tuple(step for step in column.term.steps if step[0] in "*/")
    addends = tuple((sign, number * abs(factor)) for sign, number in column.term.steps if sign in "+-")
    if factor < 0.0:
        addends = tuple(("-" if sign == "+" else "+", number) for sign, number in addends)
    return replace(column, term=Term(column.term.source, (*factors, ("*", factor), *addends)))
