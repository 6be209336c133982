"""``halltwin lab`` as it is run: it says where the page is, serves it, and ends with Ctrl-C as asked for."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from scenarios.lab.guard import ADDRESS
from tests.command_line import halltwin

ROOT = Path(__file__).parents[3]


@contextmanager
def running(*arguments: str, folder: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The command as a process, and the address that it prints."""
    start = "from scenarios.cli.main import main; main()"
    environment = os.environ | {"PYTHONPATH": str(ROOT), "TMPDIR": str(folder)}
    command = [sys.executable, "-c", start, "lab", "--no-browser", *arguments]
    with subprocess.Popen(
        command, env=environment, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        found = re.search(r"http://\S+", process.stdout.readline())
        assert found
        assert "Ctrl-C ends it" in process.stdout.readline()
        try:
            yield process, found[0]
        finally:
            process.kill()


@pytest.mark.parametrize("verbose", [(), ("--verbose",)])
def test_it_serves_until_ctrl_c_and_leaves_nothing(tmp_path: Path, verbose: tuple[str, ...]) -> None:
    with running("--twin", "hall-12bit", *verbose, folder=tmp_path) as (process, url):
        with urllib.request.urlopen(f"{url}start", timeout=20) as reply:
            assert json.load(reply)["twin"]["name"] == "hall-12bit"
        assert len(list(tmp_path.iterdir())) == 1
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
        assert process.returncode == 0
        assert out == ""
        assert "Traceback" not in err
        assert bool(err) == bool(verbose)
        assert url.split("/")[3] not in err
    assert list(tmp_path.iterdir()) == []


def test_it_leaves_nothing_where_another_program_ends_it(tmp_path: Path) -> None:
    """As a service manager does: with the exit code of a program that a signal ends."""
    with running(folder=tmp_path) as (process, url):
        with urllib.request.urlopen(f"{url}start", timeout=20):
            pass
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=20)
        assert process.returncode == 128 + signal.SIGTERM
        assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


def test_a_port_that_is_taken_is_one_line() -> None:
    with socket.create_server((ADDRESS, 0)) as taken:
        ended = halltwin("lab", "--no-browser", f"--port={taken.getsockname()[1]}")
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    assert "cannot be listened at" in ended.err


def test_a_twin_that_cannot_be_read_is_one_line_before_anything_is_served() -> None:
    ended = halltwin("lab", "--no-browser", "--twin", "imc-14bits")
    assert ended.code == 2
    assert "did you mean imc-14bit?" in ended.err
    assert ended.out == ""
