"""A broken file among many: the rest is answered, it is listed with its reason, and the exit code says so."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest

from tests.command_line import halltwin

BROKEN = {
    "b_empty.csv": b"",
    "c_cell.csv": b"reference_deg,measured_deg\n0,zero\n1,1\n",
    "d_binary.csv": bytes(range(256)),
    "e_cut.csv.gz": b"\x1f\x8b\x08\x00cut off",
    "f_few.csv": b"reference_deg,measured_deg\n0,0\n",
}


@pytest.fixture(scope="module")
def read(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("broken") / "sweeps"
    folder.mkdir()
    for number in range(5):
        sweep = folder / f"a{number}.csv"
        assert halltwin("simulate", "-o", sweep, "--points", "36", "--no-channels", "--seed", str(number)).code == 0
    return folder


@pytest.fixture
def sweeps(read: Path, tmp_path: Path) -> Path:
    """A folder of good sweeps and broken ones, one of them with a name that is no UTF-8."""
    folder = tmp_path / "sweeps"
    shutil.copytree(read, folder)
    for name, content in BROKEN.items():
        (folder / name).write_bytes(content)
    (folder / os.fsdecode(b"g_d\xe9faut\n.csv")).write_bytes(b"x,y\n1,2\n")
    (folder / "h_nobody.csv").symlink_to("nowhere")
    return folder


NAMES = (*BROKEN, "g_d\ufffdfaut\ufffd.csv", "h_nobody.csv")


def listed(out: str) -> list[str]:
    return [line.split(":")[1].strip() for line in out.splitlines() if line.startswith("not used: ")]


@pytest.mark.parametrize("command", ["diagnose", "monitor"])
def test_the_rest_is_answered(command: str, read: Path, sweeps: Path, tmp_path: Path) -> None:
    without, beside = tmp_path / "without.json", tmp_path / "with.json"
    whole = halltwin(command, read, "--json", without)
    ended = halltwin(command, sweeps, "--json", beside)
    assert whole.code == 0
    assert ended.code == 1
    assert "7 of 12 files could not be used" in ended.err
    assert ended.err.count("\n") == 1
    assert listed(ended.out) == list(NAMES)
    first, second = (json.loads(path.read_text()) for path in (without, beside))
    assert first["unusable"] == []
    assert [one["file"] for one in second["unusable"]] == list(NAMES)
    assert "line 2, column measured_deg" in second["unusable"][1]["reason"]
    # The good ones get the very answer that they get without the broken ones.
    answers = ("sweeps", "factors", "air_gaps")
    assert [first.get(key) for key in answers] == [second.get(key) for key in answers]


def test_a_correction_is_checked_on_the_rest(read: Path, sweeps: Path) -> None:
    ended = halltwin("compensate", read / "a0.csv", "--check", sweeps)
    assert ended.code == 1
    assert sum(line.startswith("on a") for line in ended.out.splitlines()) == 5
    assert listed(ended.out) == list(NAMES)


@pytest.mark.parametrize("command", [("diagnose",), ("monitor",), ("compensate", "imc-14bit", "--check")])
def test_none_that_can_be_used(command: tuple[str, ...], sweeps: Path) -> None:
    for path in sweeps.glob("a*"):
        path.unlink()
    ended = halltwin(*command, sweeps)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.count("\n") == 1
    assert "none of the other 6" in ended.err
    one = halltwin(*command, sweeps / "c_cell.csv")
    assert one.code == 2
    assert "line 2, column measured_deg" in one.err
    assert "other" not in one.err
