"""Killed in the middle: the run goes on from the last complete angle."""

from __future__ import annotations

import json
import os
import signal
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import can
import pytest

from scenarios.bench.command import Options, run
from scenarios.bench.journal import SCHEMA, finished_path, running_path
from scenarios.bench.measure import Measurement
from scenarios.bench.plan import Plan
from scenarios.bench.sequence import Patience
from scenarios.commands.file_lock import alone
from scenarios.commands.outputs import OutputFiles
from tests.command_line import halltwin
from tests.scenarios.bench.rig import PLAN, assert_same_readings, quiet_encoder, run_bench
from twin.errors import UserError
from twin.files import write_twin


def test_a_killed_run_goes_on(tmp_path: Path, undisturbed: tuple[Path, Path]) -> None:
    twin, sweep = tmp_path / "quiet.toml", tmp_path / "sweep.csv"
    write_twin(twin, quiet_encoder())
    options = ["--twin", str(twin), "--points", "64", "--both-directions", "-o", str(sweep)]
    # The encoder falls silent after its 200th frame, the 100th reading: time enough to be killed in the middle.
    command = [
        sys.executable,
        "-m",
        "scenarios.cli.main",
        "bench",
        *options,
        "--fault",
        "silent:hall=20",
        "--attempts",
        "200",
    ]
    process = subprocess.Popen(command)
    journal = running_path(sweep)
    end = time.monotonic() + 30.0
    while time.monotonic() < end and not (journal.exists() and journal.read_bytes().count(b"\n") > 100):
        time.sleep(0.005)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert not sweep.exists()
    kept = journal.read_bytes().count(b'"reading"')
    assert 100 <= kept < 128
    # The line that the kill cut off.
    with journal.open("a") as file:
        file.write('{"reading": {"index": 9')
    run(Options(output=sweep, twin=str(twin), points=64, both_directions=True))
    assert_same_readings(sweep, undisturbed[0])
    assert not journal.exists()
    assert all(json.loads(line) for line in finished_path(sweep).read_text().splitlines())


def test_a_journal_of_another_plan_is_not_continued(tmp_path: Path) -> None:
    sweep = tmp_path / "sweep.csv"
    with pytest.raises(UserError):
        run_bench(sweep, faults=["gone:hall=40"], patience=Patience(timeout_s=0.05, attempts=10))
    with pytest.raises(UserError, match="belongs to another measurement"):
        run_bench(sweep, plan=Plan(points=45))
    with pytest.raises(UserError, match="a log would lack them"):
        run_bench(sweep, record=tmp_path / "bus.log")


HEAD = {
    "schema": SCHEMA,
    "plan": PLAN.digest(),
    "twin": Measurement(plan=PLAN, output=Path(), files=OutputFiles({})).twin,
}
READING = {
    "index": 0,
    "time_s": 1.0,
    "reference_deg": 0.0,
    "measured_deg": 0.1,
    "direction": 1,
    "speed_rpm": 0.0,
    "turn": 0,
    "temperature_c": 25.0,
    "vx": 1.0,
    "vy": 0.0,
    "index_seen": True,
    "corrected": False,
}


def lines(*entries: object) -> bytes:
    """A journal that begins well."""
    return "".join(json.dumps(entry) + "\n" for entry in (HEAD, {"reading": READING}, *entries)).encode()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"not a journal\n", "is no journal of the bench"),
        (b"not a journal", "is no journal of the bench"),
        (b"\xff\xfe", "is no journal of the bench"),
        (lines() + b"{garbage\n" + lines(), "line 3 is damaged: is no JSON"),
        (lines() + b"\xff\n", "line 3 is damaged: is no JSON"),
        (lines([1]), "line 3 is damaged: is no object"),
        (lines({"reading": 7}), "line 3 is damaged: a reading has not the entries of one"),
        (lines({"reading": {**READING, "index": "7"}}), "line 3 is damaged: index is '7'"),
        (lines({"reading": {**READING, "index": 1.5}}), "line 3 is damaged: index is '1.5'"),
        (lines({"reading": {**READING, "index": 999}}), "line 3 is damaged: a reading that the plan does not hold"),
        (lines({"reading": {**READING, "measured_deg": float("nan")}}), "line 3 is damaged: measured_deg is 'nan'"),
        (lines({"reading": {**READING, "measured_deg": None}}), "line 3 is damaged: measured_deg is 'None'"),
        (lines({"reading": {**READING, "index_seen": 1}}), "line 3 is damaged: index_seen is '1'"),
    ],
)
def test_a_damaged_journal_is_one_line_and_stays(tmp_path: Path, content: bytes, said: str) -> None:
    sweep = tmp_path / "sweep.csv"
    running_path(sweep).write_bytes(content)
    with pytest.raises(UserError) as refused:
        run_bench(sweep)
    assert said in str(refused.value)
    assert "--restart" in str(refused.value)
    assert {item.name: item.read_bytes() for item in tmp_path.iterdir()} == {running_path(sweep).name: content}


@pytest.mark.parametrize("length", [0, 10, len(json.dumps(HEAD)) + 1])
def test_a_journal_without_a_reading_blocks_nothing(
    tmp_path: Path, undisturbed: tuple[Path, Path], length: int
) -> None:
    sweep = tmp_path / "sweep.csv"
    other = (json.dumps({**HEAD, "twin": "another encoder, mistyped"}) + "\n").encode()
    running_path(sweep).write_bytes(other[:length])
    run_bench(sweep)
    assert_same_readings(sweep, undisturbed[0])


@pytest.mark.parametrize(
    "options",
    [
        ("--hide", "foo"),
        ("--hide", "saturation:k_percent=much"),
        ("--twin", "nope"),
        ("--fault", "lost:nobody"),
        ("--points", "3"),
        ("--timeout", "nan"),
        ("--temperatures", "warm"),
        ("--interface", "nope"),
        ("--interface", "udp_multicast", "--hide", "hysteresis:lag_deg=1"),
    ],
    ids=" ".join,
)
def test_a_mistake_in_an_option_is_one_line_and_leaves_nothing(tmp_path: Path, options: tuple[str, ...]) -> None:
    ended = halltwin("bench", "-o", tmp_path / "sweep.csv", *options)
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_full_disk_is_one_line_and_room_lets_it_go_on(
    tmp_path: Path, undisturbed: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    sweep = tmp_path / "sweep.csv"
    with monkeypatch.context() as full:
        full.setattr(Path, "open", opened_on_a_disk_of(10_000))
        with pytest.raises(
            UserError, match=r"journal\.jsonl: cannot be written \(No space left .* of 128 readings are kept"
        ):
            run_bench(sweep)
    kept = running_path(sweep).read_bytes()
    assert 0 < kept.count(b'"reading"') < 128
    assert kept.endswith(b"}\n")
    run_bench(sweep)
    assert_same_readings(sweep, undisturbed[0])


def opened_on_a_disk_of(size: int) -> Callable[..., Any]:
    """``Path.open`` for files that take so many bytes, the last of them in half a line."""
    whole = Path.open

    class Full:
        def __init__(self, file: Any) -> None:
            self._file, self._left = file, size

        def __getattr__(self, name: str) -> Any:
            return getattr(self._file, name)

        def write(self, line: bytes) -> int:
            part = line[: self._left]
            self._left -= len(part)
            return int(self._file.write(part))

    def opened(path: Path, mode: str = "r", *arguments: Any, **named: Any) -> Any:
        file = whole(path, mode, *arguments, **named)
        return Full(file) if mode == "ab" else file

    return opened


def test_a_second_bench_for_the_same_sweep_is_refused(tmp_path: Path) -> None:
    sweep = tmp_path / "sweep.csv"
    with alone(tmp_path / "sweep.csv.lock", busy="the test's own"):
        ended = subprocess.run(
            [sys.executable, "-m", "scenarios.cli.main", "bench", "-o", str(sweep)],
            capture_output=True,
            text=True,
            check=False,
        )
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1
    assert "another halltwin measures into it" in ended.stderr
    assert not list(tmp_path.iterdir())


def test_a_bus_log_that_its_own_thread_cannot_write_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(can.SqliteWriter, "_create_db", lambda *_: sqlite3.connect(":memory:"))
    before = threading.excepthook
    with pytest.raises(UserError, match=r"bus\.db: cannot be written \(no such table: messages\)"):
        run_bench(tmp_path / "sweep.csv", record=tmp_path / "bus.db")
    assert threading.excepthook is before
