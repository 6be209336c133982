"""Units that stand in the comments of a log alone: ``# angles in rad``, ``# t: ms``, ``# enc (counts), ref [deg]``."""

from __future__ import annotations

import re
from collections.abc import Sequence

from twin.logs.names import Meaning, meaning_of
from twin.logs.units import COUNTS, unit_of

_SAID = re.compile(r"([^\W\d][\w.]*)\s*(?:\bin\b|[:=\[(])(?=\s*([^\s,;:=()\[\]]+))")
_MEASURED = ("angle", "time", "temperature", "speed", "current")
"""Roles of columns that are called as what their units measure."""


def units_remarked(names: Sequence[str], remarks: Sequence[str]) -> dict[int, str]:
    """The unit of each column whose name gives none, by its place.

    A comment names the column, or what it measures: then it holds for all columns that do so. Two units for one column
    are none.
    """
    said = [meaning_of(name) for name in names]
    found: dict[int, set[str]] = {}
    for remark in remarks:
        for word, unit in _SAID.findall(remark):
            if unit_of(unit) is None and unit.lower() not in COUNTS:
                continue
            for place in _meant(word, unit, names, said):
                found.setdefault(place, set()).add(unit)
    return {place: units.pop() for place, units in found.items() if len(units) == 1}


def _meant(word: str, unit: str, names: Sequence[str], said: Sequence[Meaning]) -> list[int]:
    """Places of the columns without a unit that a comment's word stands for."""
    bare = [k for k, one in enumerate(said) if one.unit is None and not one.counts]
    named = [k for k in bare if names[k].strip().lower() == word.lower()]
    if named:
        return named
    own = meaning_of(word)
    own = own if own.role else meaning_of(word.lower().removesuffix("s"))
    known = unit_of(unit)
    if own.role not in _MEASURED or own.role != ("angle" if known is None else known.quantity):
        return []
    # An angle's word may stand for one side alone.
    side = own.reference - own.sensor if own.role == "angle" and (own.reference or own.sensor > 1) else 0
    return [
        k for k in bare if said[k].role == own.role and (not side or (said[k].reference - said[k].sensor) * side > 0)
    ]
