"""What the engine runs: a job that computes numbered chunks, each written whole and then marked as done."""

from __future__ import annotations

from typing import Protocol

from scenarios.studies.study_folder import StudyFolder


class Job(Protocol):
    """Work in chunks; picklable, and pure: chunk k depends on the job and k alone."""

    def write(self, folder: StudyFolder, chunk: int) -> None:
        """Compute the chunk and write it whole or not at all."""


def do_chunk(job: Job, folder: StudyFolder, chunk: int) -> int:
    """One chunk, then its mark: what a worker runs. Returns the chunk's number."""
    job.write(folder, chunk)
    folder.mark(chunk)
    return chunk
