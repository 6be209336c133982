"""The README is short, and its example is what the program says."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from tests.command_line import halltwin
from tests.pages import PAGES, ROOT, block, figures, words

README = ROOT / "README.md"
MOST_LINES = 200
"""What a newcomer reads in one sitting; the rest is the guide's."""


def test_is_short() -> None:
    assert len(README.read_text(encoding="utf-8").splitlines()) <= MOST_LINES


def test_example_is_its_real_output(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Word by word; its figures to a few percent, the rank of the predictive check to some of its 199 sweeps."""
    shown = block(README, "example")
    monkeypatch.setenv("COLUMNS", "100")
    (command,) = re.findall(r"^halltwin (explain .* --report .*)$", README.read_text(encoding="utf-8"), re.MULTILINE)
    (tmp_path / "scenarios").symlink_to(ROOT / "scenarios")
    monkeypatch.chdir(tmp_path)
    out = halltwin(*command.split()).out
    assert words(shown) == words(out)
    assert "hysteresis" in shown
    (told_p, *told), (found_p, *found) = (_rank_first(text) for text in (shown, out))
    assert told_p == pytest.approx(found_p, abs=0.05)
    for one, other in zip(told, found, strict=True):
        assert one == pytest.approx(other, rel=0.03, abs=3e-4)


def _rank_first(text: str) -> list[float]:
    """The p-value of the predictive check, then all other figures."""
    rank = re.search(r"\(p = ([\d.]+)\)", text)
    assert rank
    return [float(rank[1]), *figures(text.replace(rank[0], ""))]


def test_python_lines_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """From the folder of the repository, as a reader would run them; what they might write goes elsewhere."""
    (tmp_path / "scenarios").symlink_to(ROOT / "scenarios")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(compile(block(README, "python", "python"), "README.md", "exec"), names)
    assert "hysteresis" in capsys.readouterr().out
    assert repr(names["found"]).startswith("Explanation('bench_sweep.csv', explained: hysteresis")
    # Simulated again, the gain ratio comes back within two half widths of its 95 % interval: four standard errors.
    told = names["factors"].factors["gain_ratio"]
    truth = names["found"].extended.values["gain_mismatch"]["ratio"]
    assert told.value == pytest.approx(truth, abs=told.high - told.low)


def test_extras_are_installed_by_the_same_words_everywhere() -> None:
    """From the checkout, as the project is in no registry; and each is one that there is."""
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    sources = [path for folder in ("twin", "diagnosis", "scenarios", "tests") for path in (ROOT / folder).rglob("*.py")]
    told = 0
    for path in (*PAGES, *sources):
        if path == Path(__file__):
            continue
        text = " ".join(path.read_text(encoding="utf-8").replace("`", "").split())
        assert "install halltwin" not in text, path
        assert "'halltwin[" not in text, path
        for names, behind in re.findall(r"pip install '\.\[([a-z,]+)\]'(.{16})", text):
            told += 1
            assert set(names.split(",")) <= set(extras), path
            assert behind == " in the checkout", path
    assert told > 5
