"""The README is short, and its lines of Python run; its commands are run by ``tests/test_guide_commands.py``."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from tests.pages import PAGES, ROOT, block

README = ROOT / "README.md"
MOST_LINES = 200
"""What a newcomer reads in one sitting; the rest is the guide's."""


def test_is_short() -> None:
    assert len(README.read_text(encoding="utf-8").splitlines()) <= MOST_LINES


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
