"""A study that was killed goes on with whole outcomes: a half-written line is no outcome."""

from __future__ import annotations

from pathlib import Path

from tests.kept import Kept, share


def test_what_a_killed_run_left_unfinished_is_made_anew(tmp_path: Path) -> None:
    path = tmp_path / "study.jsonl"
    Kept.read(path).add("first", {"right": True})
    with path.open("a", encoding="utf-8") as file:
        file.write('{"draw": "second", "ri')
    again = Kept.read(path)
    assert list(again.lines) == ["first"]
    again.add("second", {"right": False})
    assert Kept.read(path).lines["second"] == {"draw": "second", "right": False}
    assert Kept.read(path).lines["first"] == {"draw": "first", "right": True}


def test_a_share_has_its_exact_interval() -> None:
    """Clopper and Pearson: of 10 in 10 the lower end is 0.025 to the power of a tenth."""
    assert share(10, 10) == f"10 of 10 ({100.0 * 0.025**0.1:.0f} to 100 %)"
    assert share(0, 0) == "none"
