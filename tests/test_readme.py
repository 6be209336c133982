"""The README is short, and its example is what the program says."""

from __future__ import annotations

import pytest

from tests.command_line import halltwin
from tests.pages import ROOT, block, words

README = ROOT / "README.md"
MOST_LINES = 200
"""What a newcomer reads in one sitting; the rest is the guide's."""


def test_is_short() -> None:
    assert len(README.read_text(encoding="utf-8").splitlines()) <= MOST_LINES


def test_example_is_its_real_output(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = block(README, "example")
    monkeypatch.setenv("COLUMNS", "100")
    assert words(shown) == words(halltwin("explain", ROOT / "scenarios/data/bench_sweep.csv").out)
    assert "hysteresis" in shown
