"""Logs of drives that are known by the names of their columns, and what these names mean there."""

from __future__ import annotations

import re
from collections.abc import Sequence

from twin.logs.names import Meaning, meaning_of
from twin.logs.units import UNITS

_DEG, _RAD, _REV = UNITS["deg"], UNITS["rad"], UNITS["rev"]
_POLE_PAIRS = range(1, 31)
_VESC = frozenset({"ms_today", "tachometer", "encoder_position"})
_OF_VESC = {
    "ms_today": Meaning("time", unit=UNITS["ms"]),
    "encoder_position": Meaning("angle", sensor=2, unit=_DEG),
    # Six steps of the commutation in each turn of the field.
    "tachometer": Meaning("angle", reference=2, counts=True, turns=tuple(6 * pairs for pairs in _POLE_PAIRS)),
    "current_motor": Meaning("current", unit=UNITS["A"]),
}
_ODRIVE = re.compile(r"(?:.*\.)?(pos_estimate|pos_circular|shadow_count|count_in_cpr|pos_abs|pos_rel)")
_OF_ODRIVE = {
    "pos_setpoint": Meaning("angle", reference=1, unit=_REV),
    "input_pos": Meaning("angle", reference=1, unit=_REV),
    "pos_estimate": Meaning("angle", sensor=2, unit=_REV),
    "pos_circular": Meaning("angle", sensor=2, unit=_REV),
    "pos_abs": Meaning("angle", sensor=2, unit=_REV),
    "pos_rel": Meaning("angle", sensor=2, unit=_REV),
    "shadow_count": Meaning("angle", sensor=2, counts=True),
    "count_in_cpr": Meaning("angle", sensor=2, counts=True),
    "pos_estimate_counts": Meaning("angle", sensor=2, counts=True),
    "phase": Meaning("angle", sensor=1, unit=_RAD),
    "vel_estimate": Meaning("speed", unit=UNITS["rev/s"]),
}


def meanings_of(names: Sequence[str]) -> tuple[Meaning, ...]:
    """What the names of a log's columns mean: in a drive's log what they mean there, else what their words say."""
    if set(names) >= _VESC:
        return tuple(_OF_VESC.get(name, Meaning("other")) for name in names)
    if any(_ODRIVE.fullmatch(name) for name in names):
        return tuple(_OF_ODRIVE.get(name.rpartition(".")[2]) or meaning_of(name) for name in names)
    return tuple(map(meaning_of, names))
