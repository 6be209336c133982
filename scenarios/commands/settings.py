"""What work was begun with, held against what a run asks for: a refusal names the option that differs."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

Settings = Mapping[str, Any]
_MOST_NAMED = 3
_LONGEST = 60


def flat(content: Settings) -> dict[str, Any]:
    """Nested settings by dotted name, as JSON gives them back. Raises ValueError where they are nested without end."""
    try:
        return _flat(json.loads(json.dumps(content)))
    except RecursionError:
        raise ValueError("is nested too deep") from None


def difference(begun: Settings, asked: Settings, options: Mapping[str, str]) -> str:
    """How two nested settings differ, in words such as ``--points 36, now 40``; empty where they are equal.

    ``options`` gives the name under which a user knows a setting, or a table of them, in the order of importance. The
    first three that differ are named.
    """
    there, here = flat(begun), flat(asked)
    order = {name: place for place, name in enumerate(options)}
    other = [name for name in there.keys() | here.keys() if there.get(name) != here.get(name)]
    other.sort(key=lambda name: (order.get(_known(name, options), len(order)), name))
    said = [
        f"{_named(name, options)} {_shown(there.get(name))}, now {_shown(here.get(name))}"
        for name in other[:_MOST_NAMED]
    ]
    return "; ".join(said)


def _flat(content: Settings) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for key, value in content.items():
        if isinstance(value, Mapping):
            out.update({f"{key}.{name}": inner for name, inner in _flat(value).items()})
        else:
            out[key] = value
    return out


def _known(name: str, options: Mapping[str, str]) -> str:
    """The setting, or the table that holds it, which a user knows by another name."""
    parts = name.split(".")
    tables = (".".join(parts[:length]) for length in range(len(parts), 0, -1))
    return next((table for table in tables if table in options), name)


def _named(name: str, options: Mapping[str, str]) -> str:
    known = _known(name, options)
    rest = name.removeprefix(known).removeprefix(".")
    return " ".join(part for part in (options.get(known, known), rest) if part)


def _shown(value: Any) -> str:
    """A value as the options have it."""
    if value is None or value == []:
        return "none"
    if isinstance(value, bool):
        return "on" if value else "off"
    plain = isinstance(value, list) and not any(isinstance(item, list | dict) for item in value)
    text = ",".join(map(_shown, value)) if plain else value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."
