"""Small studies that the engine's tests run, in their own processes too: ``python -m tests.scenarios.study_jobs``."""

from __future__ import annotations

import errno
import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenarios.commands.interrupt import INTERRUPTED, Interrupted
from scenarios.studies.engine import run_study
from scenarios.studies.identity import Identity
from scenarios.studies.job import Job
from scenarios.studies.machines import Machines
from scenarios.studies.study_folder import StudyFolder

CHUNKS = 12


@dataclass(frozen=True)
class Draws:
    """Each chunk is drawn from its own stream; ``pause_s`` makes a chunk last."""

    seed: int
    pause_s: float = 0.0

    def write(self, folder: StudyFolder, chunk: int) -> list[Path]:
        rng = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(chunk,)))
        time.sleep(self.pause_s)
        return folder.save(chunk, {"value": rng.standard_normal(1000)})


@dataclass(frozen=True)
class FillsDisk:
    """The disk is full from chunk 3 on."""

    def write(self, folder: StudyFolder, chunk: int) -> list[Path]:
        if chunk >= 3:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return folder.save(chunk, {"value": np.arange(3)})


@dataclass(frozen=True)
class KillsItsWorker:
    """The first worker to reach chunk 2 dies there; the next one does it."""

    seed: int

    def write(self, folder: StudyFolder, chunk: int) -> list[Path]:
        died = folder.path.parent / "died"
        if chunk == 2 and not died.exists():
            died.touch()
            os._exit(9)
        return Draws(self.seed).write(folder, chunk)


def study(path: Path, *, seed: int = 0, pause_s: float = 0.0, machines: Machines | None = None) -> StudyFolder:
    """Begin or go on with a study of draws."""
    return run(Draws(seed, pause_s), path, seed=seed, machines=machines)


def run(job: Job, path: Path, *, seed: int = 0, chunks: int = CHUNKS, machines: Machines | None = None) -> StudyFolder:
    """Begin or go on with a study in a folder."""
    with StudyFolder.opened(path, identity(seed=seed, chunks=chunks)) as folder:
        run_study(job, folder, chunks=chunks, items=chunks, unit="chunks", machines=machines or Machines(workers=1))
    return folder


def identity(*, seed: int = 0, chunks: int = CHUNKS, study: str = "draws") -> Identity:
    """What such a study is."""
    return Identity(study=study, seed=seed, settings={"chunks": chunks}, options={"chunks": "--chunks"})


def content(path: Path) -> dict[str, bytes]:
    """Every file below a folder."""
    return {str(item.relative_to(path)): item.read_bytes() for item in path.rglob("*") if item.is_file()}


if __name__ == "__main__":
    try:
        study(Path(sys.argv[1]), pause_s=float(sys.argv[2]))
    except Interrupted as interrupted:
        # As the command line ends.
        print(interrupted, file=sys.stderr)
        raise SystemExit(INTERRUPTED) from None
