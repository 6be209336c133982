"""The ten challenge sweeps: made by a program that shares no code with this project."""

from __future__ import annotations

import json
from typing import Any

import pytest

from diagnosis import explain

from .hidden.scoring import right
from .measured import CHALLENGE

pytestmark = pytest.mark.measured


def truth() -> dict[str, Any]:
    """What is hidden in each sweep, by name."""
    content: dict[str, Any] = json.loads((CHALLENGE / "truth.json").read_text(encoding="utf-8"))
    return content


@pytest.mark.parametrize("name", [f"example{number:02d}" for number in range(10)])
def test_right(name: str) -> None:
    answer = explain(CHALLENGE / f"{name}.csv").to_dict()
    hidden = truth()[name]
    # Structure outside the catalogue bears a name of its own in the truth; the answer can only say unnamed.
    hidden["causes"] = ["unnamed" if cause.startswith("unnamed") else cause for cause in hidden["causes"]]
    given = [(cause["name"], cause["indistinguishable_from"]) for cause in answer["causes"]]
    assert right(answer, hidden), f"{hidden['causes']} is hidden, the answer is {given}"
