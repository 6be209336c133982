"""kill -9 at random moments, also while folder and store are made: of the whole process group, or the parent alone."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import numpy as np

from tests.kill_study.trials import Command, Tell, Trial, resumed

BEGINNING_S = 0.4
"""A study's folder, record and store are made within so many seconds after the folder appears."""


def kill(command: Command, work: Path, calm: Path, *, number: int, seconds: float, tell: Tell) -> None:
    """Kill one run: even trials at its beginning, odd ones at any moment; by turns the group and the parent alone.

    ``seconds`` is how long an undisturbed run takes from its first file to its end.
    """
    rng = np.random.default_rng((number, *command.name.encode()))
    alone, early = number // 2 % 2 == 1, number % 2 == 0
    while True:
        place = work / f"kill-{number}"
        process = command.start(place)
        command.wait_until_begun(process, place)
        start = time.monotonic()
        time.sleep(rng.uniform(0.0, BEGINNING_S if early else seconds))
        at = time.monotonic() - start
        if _killed(process, alone=alone):
            break
        # It had ended by itself.
        shutil.rmtree(place)
        seconds *= 0.9
    complete = command.complete(place)
    outcome, good = resumed(command, place, calm)
    done = f"{'parent' if alone else 'group'} killed {at:.2f} s after its first file, {complete} complete"
    tell(Trial(command.name, "kill", done, outcome, good))
    if good:
        shutil.rmtree(place)


def _killed(process: subprocess.Popen[str], *, alone: bool) -> bool:
    """Kill the run; False where it had ended by itself."""
    if process.poll() is not None:
        process.communicate()
        return False
    (os.kill if alone else os.killpg)(process.pid, signal.SIGKILL)
    # Not communicate: workers that outlive their parent for a moment hold the other end.
    process.wait()
    assert process.stderr is not None
    process.stderr.close()
    return process.returncode == -signal.SIGKILL
