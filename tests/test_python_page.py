"""The page about Python, and the docstrings of its interface, show what really comes out."""

from __future__ import annotations

import doctest
from importlib import import_module
from pathlib import Path

import pytest

from tests.pages import GUIDE, ROOT
from tests.shown_examples import FLAGS, Checker, docstring_examples, run_docstring, run_page

MODULES = ("diagnosis.explain", "diagnosis.diagnose", "twin.chain", "twin.motion", "twin.sweep")


def test_the_page_shows_what_comes_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run in a folder in which the repository's data lie as in its top folder, so that what it writes is left there."""
    for package in ("pandas", "xarray", "matplotlib"):
        pytest.importorskip(package)
    (tmp_path / "scenarios").mkdir()
    (tmp_path / "scenarios" / "data").symlink_to(ROOT / "scenarios" / "data")
    monkeypatch.chdir(tmp_path)
    run_page(GUIDE / "python.md")
    written = {path.name for path in tmp_path.iterdir()} - {"scenarios"}
    assert written == {"before_and_after.png", "report.html", "extended.toml"}


@pytest.mark.parametrize("found", [one for name in MODULES for one in docstring_examples(import_module(name))])
def test_a_docstring_shows_what_comes_out(found: doctest.DocTest) -> None:
    run_docstring(found)


ALIKE = ("0.134 deg", "0.135 deg"), ("RMS 1e-30", "RMS 1.01e-30"), ("a  b", "a b"), ("a ... 1.0 ...", "a b 1.01 c 7")
UNLIKE = (
    ("0.134 deg", "0.144 deg"),
    ("0.134 deg", "0.134 rad"),
    ("1440 rows", "1441 rows"),
    ("±0.011", "±0.015"),
    ("1.0", "1.0, 1.0"),
    ("a ... 1.0", "a b 1.2"),
    ("-0.2", "0.2"),
)


@pytest.mark.parametrize(("want", "got", "same"), [*((*pair, True) for pair in ALIKE), *((*p, False) for p in UNLIKE)])
def test_outputs_are_compared_word_by_word_and_number_by_number(want: str, got: str, same: bool) -> None:
    assert Checker().check_output(want, got, FLAGS) is same
