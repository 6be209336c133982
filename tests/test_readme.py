"""What the README shows is what the program says: the catalogue is generated, the example is real."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.command_line import halltwin

ROOT = Path(__file__).parents[1]


def part(name: str) -> str:
    found = re.search(f"<!-- {name} -->\n(.*?)\n<!-- /{name} -->", (ROOT / "README.md").read_text(), re.S)
    assert found, f"README.md has no part named {name}"
    return found.group(1)


def lines(text: str) -> list[str]:
    return [line.rstrip() for line in text.strip().splitlines()]


def test_catalogue_is_the_generated_one() -> None:
    assert lines(part("catalogue")) == lines(halltwin("causes", "--markdown").out)


def test_example_is_its_real_output(monkeypatch: pytest.MonkeyPatch) -> None:
    """Names, words and layout; the last digits may differ between builds of the numerical libraries."""

    def words(text: str) -> list[str]:
        return lines(re.sub(r"\d+(\.\d+)?", "#", text))

    shown = part("example").removeprefix("```text\n").removesuffix("\n```")
    monkeypatch.setenv("COLUMNS", "100")
    assert words(shown) == words(halltwin("explain", ROOT / "scenarios/data/bench_sweep.csv").out)
    assert "hysteresis" in shown
