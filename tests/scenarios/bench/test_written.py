"""What the bench measured is never lost by a command: not to itself, and not to another run."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from scenarios.bench.journal import Journal
from tests.command_line import halltwin

SHORT = ("--points", "12", "--no-chamber")
LOOP = ("bench", "--closed-loop", "--points", "24", "-o", "loop.csv")
PARTS = (
    "loop-before.csv",
    "loop-before.csv.log.jsonl",
    "loop-twin.toml",
    "loop-correction.toml",
    "loop-after.csv",
    "loop-after.csv.log.jsonl",
    "loop-report.json",
)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def refused(*arguments: str) -> str:
    """Ask a command that must refuse in one line, having changed nothing."""
    before = contents(Path())
    ended = halltwin(*arguments)
    assert (ended.code, ended.err.count("\n")) == (2, 1), ended
    assert contents(Path()) == before
    return ended.err


def test_a_pipe_in_the_logs_place_stays_one(folder: Path) -> None:
    os.mkfifo("a.csv.log.jsonl")
    ended = halltwin("bench", "-o", "a.csv", *SHORT)
    assert (ended.code, ended.err.count("\n")) == (2, 1), ended
    assert "expected a plain file" in ended.err
    assert [path.name for path in folder.iterdir()] == ["a.csv.log.jsonl"]
    assert not Path("a.csv.log.jsonl").is_file()


def test_a_file_in_the_journals_place_is_not_taken_for_it(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put there while the bench runs: it keeps its name and its bytes."""

    def in_its_place(journal: Journal) -> None:
        Path("theirs").write_text("precious")
        os.replace("theirs", journal.path)
        finish(journal)

    finish = Journal.finish
    monkeypatch.setattr(Journal, "finish", in_its_place)
    ended = halltwin("bench", "-o", "a.csv", *SHORT)
    assert ended.code == 2
    assert "another file has taken the journal's place" in ended.err
    assert Path("a.csv.journal.jsonl").read_text() == "precious"
    assert not Path("a.csv.log.jsonl").exists()


def test_a_measurement_is_replaced_with_force_alone(folder: Path) -> None:
    """Measured sweep, its log and the bus log; and they are the files that are announced."""
    measured = ("bench", "-o", "a.csv", "--record", "bus.asc", *SHORT)
    ended = halltwin(*measured)
    assert ended.code == 0
    assert {line.split()[1].strip(":") for line in ended.out.splitlines() if line.startswith("wrote")} == {
        path.name for path in folder.iterdir()
    }
    for kept in ("a.csv", "a.csv.log.jsonl", "bus.asc"):
        for other in folder.iterdir():
            os.replace(other, other.with_name(f"{other.name}.away"))
        (folder / f"{kept}.away").rename(kept)
        assert "--force" in refused(*measured)
        for other in folder.glob("*.away"):
            other.rename(other.with_suffix(""))
    first = contents(folder)
    assert halltwin(*measured, "--force").code == 0
    assert contents(folder).keys() == first.keys()
    assert contents(folder)["bus.asc"] != first["bus.asc"]


def test_a_replay_does_not_replace_its_log(folder: Path) -> None:
    assert halltwin("bench", "-o", "a.csv", "--record", "bus.csv", *SHORT).code == 0
    (folder / "link.csv").symlink_to("bus.csv")
    for name in ("bus.csv", "link.csv"):
        assert "read or written already" in refused(
            "bench", "--replay", "bus.csv", "-o", name, "--no-chamber", "--force"
        )
    assert "--force" in refused("bench", "--replay", "bus.csv", "-o", "a.csv", "--no-chamber")


def test_a_twin_is_not_replaced_by_what_is_measured_on_it(folder: Path) -> None:
    (folder / "loop-twin.toml").write_text('schema = "halltwin.twin/1"\n')
    assert "read or written already" in refused(*LOOP, "--twin", "loop-twin.toml", "--force")


def test_outputs_are_checked_before_anything_is_measured(folder: Path) -> None:
    assert "end in" in refused("bench", "-o", "a.txt", *SHORT)
    assert "end in" in refused("bench", "-o", "a.csv", "--record", "bus.txt", *SHORT)
    assert "read or written already" in refused("bench", "-o", "a.csv", "--record", "a.csv", *SHORT)
    assert "is no file" in refused("bench", "-o", "/dev/stdout", *SHORT)
    assert "no folder" in refused(*LOOP, "--plot", "no/a.png")
    for part in PARTS:
        (folder / part).write_text("somebody's own")
        assert "--force" in refused(*LOOP)
        (folder / part).unlink()


def test_a_closed_loop_announces_every_file_that_it_writes(folder: Path) -> None:
    ended = halltwin(*LOOP, "--plot", "loop.png")
    assert ended.code == 0
    announced = [line.removeprefix("wrote ") for line in ended.out.splitlines() if line.startswith("wrote ")]
    assert sorted(announced) == sorted([*PARTS, "loop.png"]) == sorted(path.name for path in folder.iterdir())
