"""One sweep of a kind: drawn, explained and judged."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from diagnosis import explain
from tests.reported_cases.kinds import KINDS
from twin.errors import UserError


class Told(NamedTuple):
    """What was said of a draw."""

    kind: str
    number: int
    right: bool
    said: str


def trial(job: tuple[str, int, int], keep: Path | None = None) -> Told:
    """Draw the sweep (kind, seed, number), explain it, judge the answer; `keep`: where the sweep is to stay."""
    name, seed, number = job
    kind = KINDS[name]
    drawn = kind.draw(np.random.default_rng([seed, list(KINDS).index(name), number]))
    with tempfile.TemporaryDirectory() as folder:
        path = drawn.write(keep or Path(folder) / f"{name}.csv")
        try:
            answer = explain(path).to_dict()
        except UserError as refusal:
            return Told(name, number, kind.refused(str(refusal)), f"refused: {str(refusal)[:200]}")
    said = ", ".join(one["name"] for one in answer["causes"]) or "nothing"
    return Told(name, number, kind.right(drawn, answer), said)
