"""The two channels of a sensor in a log: a sine and a cosine, in any unit, with or without a mid-range."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from twin.angles import Array
from twin.following import follows
from twin.logs.names import Meaning
from twin.logs.others import Found
from twin.logs.statement import Column, Term
from twin.logs.table import Table

_HALF_CODES = tuple(2.0**k for k in range(7, 24))
_HALF_VOLTS = (0.9, 1.25, 1.5, 1.65, 2.5, 5.0)
"""Middles of a converter's range: of its codes, and of its supply in volts."""
_NEAR_MIDDLE = 0.15
"""Share of the amplitude within which a channel stands at one of them: what is left is its offset."""


def channels(table: Table, said: tuple[Meaning, ...], usable: list[int], measured_deg: Array | None) -> Found:
    """``vx`` and ``vy``; left out where they are not two, or their angle is not what the sensor reports.

    ``measured_deg`` (n,) is what the sensor reports; None: their angle is it.
    """
    cos, sin = ([k for k in usable if said[k].role == role] for role in ("cos", "sin"))
    if not cos and not sin:
        return Found()
    if len(cos) != 1 or len(sin) != 1:
        return Found(why=dict.fromkeys(cos + sin, "channels are used where there is one sine and one cosine"))
    terms = [_centred(table.sources[k], table.values[k]) for k in (cos[0], sin[0])]
    columns = (Column("vx", terms[0]), Column("vy", terms[1]))
    if measured_deg is not None and not _is_angle_of(columns, table, measured_deg):
        return Found(why=dict.fromkeys(cos + sin, "their angle, atan2, does not follow the sensor's"))
    notes = tuple(f"{term} takes the middle of the converter's range off" for term in terms if term.steps)
    return Found(columns, notes)


def _is_angle_of(columns: tuple[Column, Column], table: Table, measured_deg: Array) -> bool:
    angle = np.degrees(np.arctan2(columns[1].of(table), columns[0].of(table)))
    known = np.isfinite(angle) & np.isfinite(measured_deg)
    return bool(known.sum() >= 4) and follows(angle[known], measured_deg[known])


def _centred(source: str, values: Array) -> Term:
    """A channel with the middle of its converter's range taken off, where all its codes are positive."""
    known = values[np.isfinite(values)]
    middle, amplitude = float(known.max() + known.min()) / 2.0, float(np.ptp(known)) / 2.0
    if known.min() < 0.0 or amplitude == 0.0:
        return Term(source)
    halves = _HALF_CODES if np.all(known % 1.0 == 0.0) else _HALF_VOLTS
    half = min(halves, key=lambda one: abs(one - middle))
    near = abs(half - middle) <= _NEAR_MIDDLE * amplitude
    return Term(source, (("-", half),)) if near else Term(source)


def angle_of(channels: Sequence[Column]) -> Column:
    """The sensor's angle, of the columns ``vx`` and ``vy``."""
    x, y = (column.term for column in channels)
    return Column("measured_deg", y, across=x)
