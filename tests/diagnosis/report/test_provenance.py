"""An answer says what made it, when, and how to make it again; the bytes of one day are the same."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis import diagnose, explain
from diagnosis.report.provenance import EPOCH, day, version
from tests.command_line import halltwin
from tests.pages import ROOT
from twin.angles import TAU
from twin.chain import Chain
from twin.errors import UserError
from twin.motion import Motion

KEYS = ("version", "date", "seed", "command")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six short sweeps of one device."""
    path = tmp_path_factory.mktemp("made")
    motion = Motion.from_angle(TAU * np.arange(60) / 60)
    for k in range(6):
        sensor = Chain().with_effect("offset", x_percent=0.8).with_effect("noise", rms_deg=0.02)
        sensor.simulate(motion, seed=k).write(path / f"s{k}.csv")
    return path


def answered(folder: Path, *arguments: str | Path) -> dict[str, Any]:
    assert halltwin(*arguments, "--json", folder / "answer.json").code == 0
    found: dict[str, Any] = json.loads((folder / "answer.json").read_text())
    return found


def test_the_day_is_that_of_source_date_epoch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(EPOCH, "86399")
    assert day() == "1970-01-01"
    monkeypatch.setenv(EPOCH, "86400")
    assert day() == "1970-01-02"
    for wrong in ("soon", "1e300", "9" * 40):
        monkeypatch.setenv(EPOCH, wrong)
        with pytest.raises(UserError, match="expected whole seconds"):
            day()


@pytest.mark.parametrize("name", ["explain", "diagnose", "monitor"])
def test_the_command_in_the_json_makes_the_same_answer(
    name: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Under another day's clock only the date may differ."""
    monkeypatch.setenv(EPOCH, "0")
    sweeps = sorted(folder.glob("s*.csv"))[: 1 if name == "explain" else None]
    first = answered(tmp_path, name, *sweeps, "--seed", "3")
    assert first["command"] == shlex.join(["halltwin", name, *map(str, sweeps), "--seed", "3"])
    monkeypatch.setenv(EPOCH, "86400")
    again = answered(tmp_path, *shlex.split(first["command"])[1:])
    assert (first.pop("date"), again.pop("date")) == ("1970-01-01", "1970-01-02")
    # The digest of all else.
    del first["written_by"], again["written_by"]
    assert again == first
    assert first["version"] == version()
    assert first["seed"] == 3


def test_outputs_and_the_way_it_is_run_are_no_part_of_the_command(folder: Path, tmp_path: Path) -> None:
    told = answered(
        tmp_path, "diagnose", folder / "s0.csv", "-v", "--plot", tmp_path / "a.png", "--fail-on", "undetermined"
    )
    assert told["command"] == f"halltwin diagnose {folder / 's0.csv'} --seed 0"


def test_files_of_one_name_and_patterns_are_told_as_they_were_typed(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for place in ("a", "b"):
        (tmp_path / place).mkdir()
        (tmp_path / place / "s.csv").write_bytes((folder / f"s{'ab'.index(place)}.csv").read_bytes())
    told = answered(tmp_path, "diagnose", "a/s.csv", "b/s.csv", "?/s.csv")
    assert told["command"] == "halltwin diagnose a/s.csv b/s.csv '?/s.csv' --seed 0"


def test_what_decides_the_answer_is(folder: Path, tmp_path: Path) -> None:
    told = answered(tmp_path, "monitor", folder, "--run-length", "200", "--seed", "1")
    assert told["command"] == f"halltwin monitor {folder} --run-length 200.0 --seed 1"
    gear = ROOT / "scenarios/data/gear_mesh.py"
    told = answered(tmp_path, "explain", folder / "s0.csv", "--effects", gear, "--twin", "paper-encoder")
    sweep = folder / "s0.csv"
    assert told["command"] == f"halltwin explain {sweep} --twin paper-encoder --effects {gear} --seed 0"


def test_the_report_says_it_too(folder: Path, tmp_path: Path) -> None:
    report = tmp_path / "r.html"
    told = answered(tmp_path, "explain", folder / "s0.csv", "--report", report)
    page = report.read_text(encoding="utf-8")
    assert f"halltwin {told['version']} on {told['date']} (UTC) with seed 0" in page
    assert f"<code>{told['command']}</code>" in page


def test_a_call_from_python_has_no_command(folder: Path) -> None:
    for answer in (explain(folder / "s0.csv", seed=2).to_dict(), diagnose(folder / "s0.csv", seed=2).to_dict()):
        assert [answer[key] for key in KEYS] == [version(), day(), 2, None]


def test_the_same_bytes_in_two_processes(folder: Path) -> None:
    """Nothing of the process, its time of day included, gets into the JSON."""
    for name in ("a", "b"):
        command = [sys.executable, "-m", "scenarios.cli.main", "diagnose", folder / "s1.csv", "-q"]
        subprocess.run([*command, "--json", folder / f"{name}.json"], cwd=ROOT, check=True)
    assert (folder / "a.json").read_bytes() == (folder / "b.json").read_bytes()
