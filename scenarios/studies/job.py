"""What the engine runs: a job that computes numbered chunks, each written whole and then marked as done."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from scenarios.studies.study_folder import StudyFolder


class Job(Protocol):
    """Work in chunks; picklable, and pure: chunk k depends on the job and k alone."""

    def write(self, folder: StudyFolder, chunk: int) -> Sequence[Path]:
        """Compute the chunk and write its files, each whole or not at all; returns them."""


def do_chunk(job: Job, folder: StudyFolder, chunk: int) -> int:
    """One chunk, then its mark: what a worker runs. Returns the chunk's number."""
    folder.mark(f"{chunk:06d}", job.write(folder, chunk))
    return chunk
