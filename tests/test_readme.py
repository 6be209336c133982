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


def words(text: str) -> list[str]:
    """Lines with their figures left out: the last digits may differ between builds of the numerical libraries."""
    return lines(re.sub(r"\d+(\.\d+)?", "#", text))


def block(name: str, kind: str = "text") -> str:
    """The code block that a part of the README consists of."""
    return part(name).removeprefix(f"```{kind}\n").removesuffix("\n```")


def test_example_is_its_real_output(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = block("example")
    monkeypatch.setenv("COLUMNS", "100")
    assert words(shown) == words(halltwin("explain", ROOT / "scenarios/data/bench_sweep.csv").out)
    assert "hysteresis" in shown


OWN = ROOT / "scenarios/data/gear_mesh.py"


@pytest.mark.parametrize(("name", "options"), [("unnamed", ()), ("named", ("--effects", OWN))])
def test_own_effect_is_its_real_output(
    name: str, options: tuple[str | Path, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The table of causes as it stands in the output, and its figures to a few percent."""
    monkeypatch.setenv("COLUMNS", "100")
    shown, out = block(name), halltwin("explain", ROOT / "scenarios/data/gear_sweep.csv", *options).out.rstrip()
    # lines() strips blanks at both ends of a text, so the first line's own are put aside.
    wanted, said = words(shown), words(out)
    wanted[0] = next(line for line in said if line.strip() == wanted[0])
    start = said.index(wanted[0])
    assert said[start : start + len(wanted)] == wanted
    real = "\n".join(lines(out)[start : start + len(wanted)])
    for told, found in zip(figures(shown), figures(real), strict=True):
        assert told == pytest.approx(found, rel=0.03, abs=3e-4)


def figures(text: str) -> list[float]:
    """The numbers in a text that have decimals, without half widths."""
    return [float(number) for number in re.findall(r"(?<!±)\b\d+\.\d+", text)]


def test_own_effect_is_the_shipped_file() -> None:
    assert OWN.read_text().endswith(f"\n{block('own', 'python')}\n")
    assert "import" not in block("own", "python")
