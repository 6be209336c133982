"""Full disks: a small tmpfs in a mount namespace of its own, filled up to a level, and then given room.

``python -m tests.kill_study.disks COMMAND CALM LEVELS`` tries one command and prints a trial a line, as JSON.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

from tests.kill_study.trials import COMMANDS, DEVICES, ROOT, TWIN, Command, Tell, Trial, resumed

SIZE = "256m"


def can_mount() -> bool:
    """Whether this user may mount a small disk."""
    mounts = ["unshare", "-rm", "mount", "-t", "tmpfs", "-o", f"size={SIZE}", "none", tempfile.gettempdir()]
    try:
        return subprocess.run(mounts, capture_output=True, check=False).returncode == 0
    except OSError:
        return False


def fill(command: Command, calm: Path, *, levels: int, tell: Tell) -> None:
    """Try the levels, from no room at all up to just less than what the command writes."""
    arguments = [sys.executable, "-m", "tests.kill_study.disks", command.name, str(calm), str(levels)]
    with subprocess.Popen(["unshare", "-rm", *arguments], cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            tell(Trial(**json.loads(line)))
    if process.returncode != 0:
        tell(Trial(command.name, "disk", "trials", f"ended with {process.returncode}", good=False))


def levels_of(command: Command, disk: Path, calm: Path, levels: int) -> Iterator[Trial]:
    """One trial a level on the disk mounted there."""
    shutil.copy(calm.parent / TWIN, disk / TWIN)
    shutil.copytree(calm.parent / DEVICES, disk / DEVICES)
    need = _needed(disk, calm)
    for level in range(levels):
        place, ballast = disk / f"disk-{level}", disk / "ballast"
        place.mkdir()
        # Closer together where folder, record and store are made.
        room = need * level**2 // levels**2
        _fill_up(disk, ballast, room)
        first = command.run(place)
        ballast.unlink()
        done = f"{room / 1024:.0f} KiB of {need / 1024:.0f} free, {command.complete(place)} complete"
        if first.code != 0 and not first.refused:
            yield Trial(command.name, "disk", done, f"exit {first.code}: {first.last_line}", good=False)
            continue
        outcome, good = resumed(command, place, calm)
        # Room is what was missing: no second refusal.
        good = good and not outcome.startswith("refused")
        yield Trial(command.name, "disk", done, outcome if first.code else f"no refusal; {outcome}", good)
        shutil.rmtree(place)


def _free(disk: Path) -> int:
    found = os.statvfs(disk)
    return found.f_bavail * found.f_frsize


def _needed(disk: Path, calm: Path) -> int:
    """The room that an undisturbed run's files take."""
    before = _free(disk)
    shutil.copytree(calm, disk / "calm")
    need = before - _free(disk)
    shutil.rmtree(disk / "calm")
    return need


def _fill_up(disk: Path, ballast: Path, room: int) -> None:
    with ballast.open("wb") as file:
        os.posix_fallocate(file.fileno(), 0, _free(disk) - room)


def main() -> None:
    """See the module's text."""
    name, calm, levels = sys.argv[1:]
    command = next(one for one in COMMANDS if one.name == name)
    with tempfile.TemporaryDirectory() as folder:
        mounts = ["mount", "-t", "tmpfs", "-o", f"size={SIZE}", "none", folder]
        subprocess.run(mounts, check=True)
        try:
            for trial in levels_of(command, Path(folder), Path(calm), int(levels)):
                print(json.dumps(asdict(trial)), flush=True)
        finally:
            subprocess.run(["umount", "--lazy", folder], check=False)


if __name__ == "__main__":
    main()
