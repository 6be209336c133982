"""Killed in the middle: the run goes on from the last complete angle."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scenarios.bench.command import Options, run
from scenarios.bench.journal import running_path
from scenarios.bench.plan import Plan
from scenarios.bench.sequence import Patience
from tests.scenarios.bench.rig import assert_same_readings, quiet_encoder, run_bench
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


def test_a_journal_of_another_plan_is_not_continued(tmp_path: Path) -> None:
    sweep = tmp_path / "sweep.csv"
    with pytest.raises(UserError):
        run_bench(sweep, faults=["gone:hall=40"], patience=Patience(timeout_s=0.05, attempts=10))
    with pytest.raises(UserError, match="belongs to another measurement"):
        run_bench(sweep, plan=Plan(points=45))
    with pytest.raises(UserError, match="a log would lack them"):
        run_bench(sweep, record=tmp_path / "bus.log")


def test_a_journal_that_is_none_is_one_line(tmp_path: Path) -> None:
    sweep = tmp_path / "sweep.csv"
    running_path(sweep).write_text("not a journal\n")
    with pytest.raises(UserError, match="is no journal of the bench"):
        run_bench(sweep)
