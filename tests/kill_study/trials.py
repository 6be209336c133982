"""What is tried: commands of some seconds, how they are started, and whether they left what an undisturbed run does."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.hidden.fleets.generator import Plan, write
from twin.files import write_twin
from twin.presets import read_preset
from twin.sweep_reader import read_columns

ROOT = Path(__file__).parents[2]
LONGEST_S = 300.0
"""No run takes so long, be the machine ever so busy: one that does is taken to hang."""
STUDY, SWEEP, TWIN, DEVICES = "study", "sweep.csv", "encoder.toml", "devices"
GENERATE = ("generate", "-n", "1600", "--chunk", "40")
RECOVER = (
    *("recover", "--cause", "baseline", "--cause", "clean", "--noise", "0.02,0.05"),
    *("--points", "36,48,60,72", "--turns", "1", "--fits", "20", "--sweeps", "1"),
)
DESIGN = ("design", "--diameter", "4:8:0.5", "--height", "2.5,3", "--air-gap", "1:3:0.5", "--mountings", "60")
FLEET = Plan(count=400, cause="hysteresis", strength_deg=0.006, points=180, odd={4: ("drive_ripple", 0.1)})
"""Two looks at each device, and one that stands apart and is explained."""
BENCH = ("bench", "--points", "300", "--both-directions")


@dataclass(frozen=True)
class Command:
    """A command of halltwin that works in a folder of a trial: a study on a pool of processes, or a bench.

    ``of_devices``: the study is of the files of devices beside the trial.
    """

    name: str
    given: tuple[str, ...]
    study: bool = True
    workers: int = 2
    of_devices: bool = False

    def arguments(self, place: Path) -> list[str]:
        """The whole command line."""
        devices = (str(place.parent / DEVICES),) if self.of_devices else ()
        where = (
            ("--workers", str(self.workers), "-o", str(place / STUDY))
            if self.study
            else ("--twin", str(place.parent / TWIN), "-o", str(place / SWEEP))
        )
        return [sys.executable, "-m", "scenarios.cli.main", *self.given, *devices, *where]

    def start(self, place: Path) -> subprocess.Popen[str]:
        """Start it in a process group of its own."""
        place.mkdir(parents=True, exist_ok=True)
        return subprocess.Popen(
            self.arguments(place),
            cwd=ROOT,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def run(self, place: Path) -> Ended:
        """Run it to its end."""
        return ended(self.start(place))

    def begun(self, place: Path) -> bool:
        """Whether it has begun to write."""
        return (place / STUDY if self.study else place / f"{SWEEP}.journal.jsonl").exists()

    def wait_until_begun(self, process: subprocess.Popen[str], place: Path) -> None:
        """Wait until a run has begun to write, or has ended."""
        while process.poll() is None and not self.begun(place):
            time.sleep(0.001)

    def complete(self, place: Path) -> int:
        """Chunks or readings that are complete."""
        if self.study:
            return sum(mark.name.isdigit() for mark in (place / STUDY / "done").glob("*"))
        journal = place / f"{SWEEP}.journal.jsonl"
        return journal.read_bytes().count(b'"reading"') if journal.exists() else 0

    def difference(self, found: Path, calm: Path) -> str:
        """What a trial left that differs from an undisturbed run, empty where nothing does.

        Studies are equal byte for byte. A bench that went on has another time; its log says what happened.
        """
        here, there = (files(place) for place in (found, calm))
        if odd := sorted(here.keys() ^ there.keys()):
            return f"{odd[0]} {'is there' if odd[0] in here else 'is missing'}"
        if self.study:
            return next((f"{name} differs" for name in sorted(here) if here[name] != there[name]), "")
        one, other = (read_columns(place / SWEEP) for place in (found, calm))
        wrong = [name for name in other if name != "time_s" and not np.array_equal(one[name], other[name])]
        return f"column {wrong[0]} differs" if wrong else ""


COMMANDS = (
    Command("generate", GENERATE),
    Command("recover", RECOVER),
    Command("design", DESIGN),
    Command("fleet", ("fleet",), of_devices=True),
    Command("bench", BENCH, study=False),
)


@dataclass(frozen=True)
class Ended:
    """How a run ended."""

    code: int
    said: str

    @property
    def refused(self) -> bool:
        """Whether it was refused as it should be: exit code 2, one line."""
        # On a busy machine a study says on the way how far it is.
        told = [line for line in self.said.splitlines() if line.startswith("halltwin: ")]
        lines = [line for line in told if not line.startswith("halltwin: after ")]
        return self.code == 2 and len(lines) == 1 and "Traceback" not in self.said

    @property
    def last_line(self) -> str:
        """What it said last."""
        return (self.said.strip().splitlines() or ["nothing"])[-1]


def ended(process: subprocess.Popen[str]) -> Ended:
    """Wait for a run."""
    _, said = process.communicate(timeout=LONGEST_S)
    return Ended(process.returncode, said)


@dataclass(frozen=True)
class Trial:
    """One thing tried: what was done, what came of it, and whether that is as promised."""

    command: str
    kind: str
    done: str
    outcome: str
    good: bool


Tell = Callable[[Trial], None]


def resumed(command: Command, place: Path, calm: Path) -> tuple[str, bool]:
    """Run the command again after what was done to it, and hold what is there against an undisturbed run.

    A bench that was complete when it was killed is refused: what was measured is not replaced.
    """
    again = command.run(place)
    if again.code != 0 and not again.refused:
        return f"exit {again.code}: {again.last_line}", False
    difference = command.difference(place, calm)
    said = f"refused: {again.last_line}" if again.refused else "resumed, equal"
    return f"{said}; {difference}" if difference else said, not difference


def write_inputs(work: Path) -> None:
    """The encoder on the bench, without noise since a bench that goes on draws other noise; devices of a batch."""
    write_twin(work / TWIN, read_preset("paper-encoder").without("noise"))
    write(FLEET, work / DEVICES, seed=3)


def files(place: Path) -> dict[str, bytes]:
    """Every file below a folder, but the empty lock of a bench that was killed as it ended."""
    found = {str(item.relative_to(place)): item.read_bytes() for item in sorted(place.rglob("*")) if item.is_file()}
    return {name: content for name, content in found.items() if content or not name.endswith(f"{SWEEP}.lock")}
