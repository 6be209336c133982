"""Long checks of the studies: ``pytest -m study tests/scenarios/test_studies_long.py``, some minutes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from tests.scenarios.study_jobs import content

ROOT = Path(__file__).parents[2]
COMMAND = (
    sys.executable,
    "-m",
    "scenarios.cli.main",
    "generate",
    "-n",
    "60000",
    "--chunk",
    "200",
    "--workers",
    "2",
    "-o",
)


@pytest.mark.study
def test_generate_killed_twenty_times_is_as_undisturbed(tmp_path: Path) -> None:
    pytest.importorskip("zarr", reason="needs the extra 'sweeps'")
    rng = np.random.default_rng(0)
    killed = 0
    while killed < 20:
        process = subprocess.Popen([*COMMAND, str(tmp_path / "killed")], cwd=ROOT, stdout=subprocess.DEVNULL)
        time.sleep(rng.uniform(1.0, 4.0))
        if process.poll() is not None:
            break
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        killed += 1
    assert killed >= 5
    for name in ("killed", "calm"):
        subprocess.run([*COMMAND, str(tmp_path / name)], cwd=ROOT, check=True)
    assert content(tmp_path / "killed") == content(tmp_path / "calm")


@pytest.mark.study
def test_a_full_disk_stops_generate_and_room_lets_it_go_on(tmp_path: Path) -> None:
    pytest.importorskip("zarr", reason="needs the extra 'sweeps'")
    script = f"""
set -e
mkdir {tmp_path}/disk && mount -t tmpfs -o size=6m none {tmp_path}/disk
run() {{ {sys.executable} -m scenarios.cli.main generate -n 8000 --chunk 500 --workers 2 -o "$1"; }}
! run {tmp_path}/disk/s
mount -o remount,size=60m {tmp_path}/disk
run {tmp_path}/disk/s && run {tmp_path}/disk/calm
diff -r {tmp_path}/disk/s {tmp_path}/disk/calm
"""
    done = subprocess.run(
        ["unshare", "-rm", "bash", "-c", script], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if "unshare" in done.stderr or "mount" in done.stderr:
        pytest.skip("needs user namespaces to mount a small disk")
    assert done.returncode == 0, done.stderr
    assert "the disk is full" in done.stderr
