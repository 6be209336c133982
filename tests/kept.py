"""Outcomes of a study kept in a file as they come, one line of JSON each, so that a study goes on where it stopped."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from scipy.stats import binomtest


@dataclass(frozen=True)
class Kept:
    """What a file holds, by the draw that each line names; without a file nothing is kept.

    A line that a killed run left unfinished is cut off.
    """

    path: Path | None = None
    lines: dict[str, dict[str, Any]] = field(default_factory=dict)

    @classmethod
    def read(cls, path: Path | None) -> Kept:
        """What earlier runs left in the file."""
        kept = cls(path)
        if path is None or not path.exists():
            return kept
        text = path.read_text(encoding="utf-8")
        whole = text[: text.rfind("\n") + 1]
        if whole != text:
            os.truncate(path, len(whole.encode("utf-8")))
        for line in whole.splitlines():
            told = json.loads(line)
            kept.lines[told["draw"]] = told
        return kept

    def add(self, draw: str, outcome: Mapping[str, Any]) -> None:
        """Keep one outcome, written through to the disk."""
        self.lines[draw] = {"draw": draw, **outcome}
        if self.path is None:
            return
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(self.lines[draw]) + "\n")
            file.flush()
            os.fsync(file.fileno())


def share(count: int, total: int) -> str:
    """A count of so many, with the exact 95 % interval of the share that it estimates (Clopper and Pearson)."""
    if not total:
        return "none"
    interval = binomtest(count, total).proportion_ci(0.95, "exact")
    return f"{count} of {total} ({100.0 * interval.low:.0f} to {100.0 * interval.high:.0f} %)"
