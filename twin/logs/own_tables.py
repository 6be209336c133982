"""The tables in C that ``halltwin export`` writes, ``--for c`` and ``--for autosar``, under whatever name.

The shaft's angle is SENSE times the reading, less ZERO, plus what the table adds, all in codes of 16 bit.
"""

from __future__ import annotations

from collections.abc import Mapping

from twin.logs.statement import Addend, Column, Term
from twin.logs.table import Table

_DEG_PER_TURN, _CODES = 360.0, 65_536.0
_KINDS = {
    "entry": "taken as a table of C that halltwin writes: entries are added to the reading",
    "y": "taken as a curve: what is added to the reading, by the reading, both in codes of 16 bit",
}
"""How the names of arrays with what is added end, and in words what is taken for granted."""


def is_own(name: str, constants: Mapping[str, float]) -> bool:
    """Whether an array of this name stands beside the macros that tell how halltwin's C applies it."""
    prefix, _, kind = name.rpartition("_")
    return kind in _KINDS and _macro(prefix, "SENSE", constants) in (1.0, -1.0)


def own_statements(table: Table) -> tuple[list[tuple[Column, Column]], tuple[str, ...]]:
    """The statements for the tables of halltwin's C, and what is taken for granted in them; none for others."""
    found: list[tuple[Column, Column]] = []
    notes: tuple[str, ...] = ()
    for k, name in enumerate(table.names):
        prefix, _, kind = name.rpartition("_")
        axis = {"entry": table.names[0], "y": f"{prefix}_x"}.get(kind)
        if axis not in table.names or not is_own(name, table.constants):
            continue
        per = float(table.values[k].size) if kind == "entry" else _CODES
        sense = _macro(prefix, "SENSE", table.constants)
        zero = _macro(prefix, "ZERO", table.constants)
        source = table.sources[table.names.index(axis)]
        shaft = Term(source, (("*", sense * _DEG_PER_TURN), ("/", per), *_less(zero)))
        added = Addend("+", Term(table.sources[k], (("*", _DEG_PER_TURN), ("/", _CODES))))
        reading = Term(source, (("*", _DEG_PER_TURN), ("/", per)))
        found.append((Column("reference_deg", shaft, plus=added), Column("measured_deg", reading)))
        notes = (_KINDS[kind] + ("; the reading counts against the shaft" if sense < 0.0 else ""),)
    return found, notes


def _macro(prefix: str, what: str, constants: Mapping[str, float]) -> float:
    return constants.get(f"{prefix.upper()}_{what}", 0.0)


def _less(zero: float) -> tuple[tuple[str, float], ...]:
    return (("-", zero * _DEG_PER_TURN / _CODES),) if zero else ()
