"""A table of a twin file as a frozen dataclass, and back: every name and number checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

from twin.known_names import nearest
from twin.limits import OutOfRangeError
from twin.shown import shown

Part = TypeVar("Part")
UNLISTED = {"unlisted": True}
"""Metadata of a field that is read where it stands, and that no message offers."""


def from_table(kind: type[Part], content: Any, where: str) -> Part:
    """An instance of the dataclass ``kind`` with the table's values, the rest at their defaults.

    ``where`` names the table in messages, which do not offer a field that is :data:`UNLISTED`.
    Raises OutOfRangeError for an unknown name or a value out of range.
    """
    known = {item.name: item for item in fields(kind)}  # type: ignore[arg-type]
    if not isinstance(content, Mapping):
        raise OutOfRangeError(f"{where} is {shown(content)}; expected a table")
    values = {}
    for key, value in content.items():
        if key not in known:
            listed = [name for name, item in known.items() if item.metadata != UNLISTED]
            raise OutOfRangeError(f"{where} has no '{key}'{nearest(key, listed)}; it has {', '.join(listed)}")
        default = known[key].default
        if isinstance(value, list | Mapping):
            raise OutOfRangeError(f"{key} is {shown(value)}; expected a single value")
        # Python takes true for 1 and any text for true; a twin file does not.
        if isinstance(value, bool) != isinstance(default, bool):
            kind_of = "true or false" if isinstance(default, bool) else "a number or a word, not true or false"
            raise OutOfRangeError(f"{key} is {shown(value)}; expected {kind_of}")
        if isinstance(value, str) != isinstance(default, str):
            raise OutOfRangeError(
                f"{key} is {shown(value)}; expected a {'word' if isinstance(default, str) else 'number'}"
            )
        whole = isinstance(default, int) and isinstance(value, float) and value.is_integer()
        values[key] = int(value) if whole else value
    return kind(**values)


def to_table(part: Any) -> dict[str, Any]:
    """Those values of a dataclass that differ from its defaults, as plain values."""
    default, changed = type(part)(), {}
    for item in fields(part):
        value = getattr(part, item.name)
        if value is not None and value != getattr(default, item.name):
            changed[item.name] = value if isinstance(value, str | bool | int) else float(np.asarray(value))
    return changed
