"""What a study's folder was begun with, held against what a run asks for."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from diagnosis.report.provenance import version
from scenarios.commands.settings import Settings, difference, flat
from twin.bounded_input import LARGEST_TEXT_BYTES
from twin.errors import UserError
from twin.regular_file import content

_ENTRIES = ("study", "version", "seed", "settings")


@dataclass(frozen=True, kw_only=True)
class Identity:
    """The study by name, and everything that its results depend on besides the program's version.

    ``options`` are the settings, or tables of them, under the names that a user gives them, in the order of importance.
    """

    study: str
    seed: int
    settings: Settings
    options: Mapping[str, str] = field(default_factory=dict)

    def record(self) -> dict[str, Any]:
        """As plain values."""
        return dict(zip(_ENTRIES, (self.study, version(), self.seed, self.settings), strict=True))

    def text(self) -> str:
        """The text of the record. Raises ValueError for a figure that is not finite."""
        return json.dumps(self.record(), indent=1, sort_keys=True, allow_nan=False) + "\n"

    def difference(self, found: Settings) -> str:
        """How another record differs, in words; empty where it does not."""
        named = {f"settings.{name}": option for name, option in self.options.items()}
        options = {"study": "the study", "version": "halltwin", **named, "seed": "--seed", "settings": ""}
        return difference(found, self.record(), options)


def read_record(record: Path) -> dict[str, Any]:
    """What a folder was begun with. Raises UserError where the record is none."""
    try:
        found = json.loads(content(record, most=LARGEST_TEXT_BYTES, expected="the record of a study"))
        if not isinstance(found, dict) or found.keys() != set(_ENTRIES) or not isinstance(found["settings"], dict):
            raise ValueError("has not the entries of a record")
        flat(found)
    except UserError:
        raise
    except (OSError, ValueError, RecursionError):
        raise UserError(f"{record}: is damaged or no record of a study; give another folder") from None
    return found
