"""What a study's folder was begun with, held against what a run asks for."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from twin.errors import UserError

Settings = Mapping[str, Any]


def read_record(record: Path) -> dict[str, Any]:
    """The settings that a folder was begun with, by dotted name. Raises UserError where the record is none."""
    try:
        content = json.loads(record.read_text(encoding="utf-8"))
        if not isinstance(content, dict) or not isinstance(content.get("settings"), dict):
            raise ValueError("no settings")
    except (OSError, ValueError, RecursionError):
        raise UserError(f"{record}: is damaged or no record of a study; give another folder") from None
    return flat(content)


def refuse_other(path: Path, found: Settings, asked: Settings) -> None:
    """Raise UserError where a folder was begun with other settings than are asked for, naming the first."""
    for name in sorted(found.keys() | asked.keys(), key=lambda key: (key.count("."), key)):
        if found.get(name) != asked.get(name):
            there, here = (_short(settings.get(name)) for settings in (found, asked))
            raise UserError(
                f"{path}: was begun with {name} {there}, this run has {here}; give another folder, "
                "or the same settings to go on"
            )


def flat(content: Settings) -> dict[str, Any]:
    """Nested settings by dotted name; the settings themselves without their own prefix."""
    out: dict[str, Any] = {}
    for key, value in content.items():
        if isinstance(value, Mapping):
            prefix = "" if key == "settings" else f"{key}."
            out.update({f"{prefix}{name}": inner for name, inner in flat(value).items()})
        else:
            out[key] = value
    return out


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
