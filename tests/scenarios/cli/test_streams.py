"""Standard output that is full, closed, or read by nobody: one line at most, a fitting exit code, no traceback."""

from __future__ import annotations

import contextlib
import io
import os
import subprocess
import sys
from pathlib import Path
from unittest import mock

import pytest

from scenarios.cli.app import app
from scenarios.cli.main import main
from scenarios.cli.streams import READER_GONE
from tests.pages import ROOT

pytestmark = pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full device")

CALLBACKS = [(command.name, command.callback) for command in app.registered_commands]
COMMANDS = [name or callback.__name__.replace("_", "-") for name, callback in CALLBACKS if callback is not None]
SWEEP = str(ROOT / "scenarios/data/bench_sweep.csv")
ANSWERING = [
    ("causes",),
    ("causes", "--markdown"),
    ("simulate", "-o", "a.csv"),
    ("diagnose", SWEEP),
    ("compensate", SWEEP),
    ("new-effect", "gear_mesh"),
    ("check-effect", str(ROOT / "scenarios/data/gear_mesh.py")),
    ("--version",),
    *((command, "--help") for command in COMMANDS),
]


def on_a_full_device(*arguments: str) -> str:
    """Standard error of a command that cannot print its answer, and ends so."""
    err = io.StringIO()
    with (
        open("/dev/full", "w", encoding="utf-8") as full,
        mock.patch.object(sys, "argv", ["halltwin", *arguments]),
        contextlib.redirect_stdout(full),
        contextlib.redirect_stderr(err),
        pytest.raises(SystemExit) as ended,
    ):
        main()
    assert ended.value.code == 2
    return err.getvalue()


@pytest.mark.parametrize("arguments", ANSWERING, ids=" ".join)
def test_a_full_device_is_one_line(arguments: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    said = on_a_full_device(*arguments)
    assert said.startswith("halltwin: standard output cannot be written (No space left on device)")
    assert said.count("\n") == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ("export", SWEEP, "--for", "c", "-o", "table.h"),
        ("compensate", SWEEP, "--header", "table.h"),
        ("doctor", SWEEP, "--json", "table.json"),
    ],
    ids=" ".join,
)
def test_files_are_written_whatever_becomes_of_what_is_printed(
    arguments: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    on_a_full_device(*arguments)
    assert (tmp_path / arguments[-1]).stat().st_size > 0


def ended(*arguments: str, unbuffered: str, stdout: int) -> tuple[int, bytes]:
    """Exit code and standard error of the program as a process of its own, to the end of its interpreter."""
    command = [sys.executable, "-m", "scenarios.cli.main", *arguments]
    environment = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    done = subprocess.run(command, cwd=ROOT, env=environment, stdout=stdout, stderr=subprocess.PIPE, check=False)
    return done.returncode, done.stderr


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("arguments", [("causes", "--markdown"), ("explain", "--help")], ids=" ".join)
def test_nobody_reads_the_pipe(arguments: tuple[str, ...], unbuffered: str) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    assert ended(*arguments, unbuffered=unbuffered, stdout=writer) == (READER_GONE, b"")
    os.close(writer)


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_full_device_to_the_end_of_the_interpreter(unbuffered: str) -> None:
    with open("/dev/full", "wb") as full:
        code, said = ended("causes", "--markdown", unbuffered=unbuffered, stdout=full.fileno())
    assert code == 2
    assert said.count(b"\n") == 1


def test_a_closed_output_is_not_printed_into_what_is_opened_next(tmp_path: Path) -> None:
    command = f"{sys.executable} -m scenarios.cli.main simulate -o {tmp_path}/a.csv >&- 2>&-"
    assert subprocess.run(command, shell=True, cwd=ROOT, check=False).returncode == 0
    assert b"wrote" not in (tmp_path / "a.csv").read_bytes().split(b"\n", 1)[1]


def test_an_output_that_knows_few_letters(tmp_path: Path) -> None:
    """A file's name and a folder's in Latin-1, and a terminal in ASCII."""
    folder = os.fsencode(tmp_path) + b"/\xe9t\xe9"
    os.mkdir(folder)
    sweep, program = folder + b"/d\xe9faut.csv", [os.fsencode(sys.executable), b"-m", b"scenarios.cli.main"]
    pictures = [
        option for name in (b"plot", b"convergence") for option in (b"--" + name, folder + b"/\xe9" + name + b".svg")
    ]
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    for arguments in (
        [b"simulate", b"-o", sweep, b"--points", b"36", b"--turns", b"5"],
        [b"diagnose", sweep, b"--json", sweep[:-4] + b".json", *pictures],
        [b"compensate", sweep, b"--header", sweep[:-4] + b".h", b"--toml", sweep[:-4] + b".toml"],
    ):
        done = subprocess.run([*program, *arguments], cwd=ROOT, env=environment, capture_output=True, check=False)
        assert (done.returncode, done.stderr) == (0, b"")
