"""One engine for all studies: numbered chunks of work, on a process pool or a Dask cluster, resumed where they stopped.

A :class:`~scenarios.studies.job.Job` is a picklable description that computes chunk k and writes it whole or not at
all. What a chunk holds depends on the job and k alone, so who computes it, and how often, does not show in the result.
A chunk counts as done when its mark stands in the study's folder, and its files are as the mark says; the mark is
written last.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager

from scenarios.studies.job import Job
from scenarios.studies.machines import Machines
from scenarios.studies.progress import progress
from scenarios.studies.study_folder import StudyFolder
from twin.errors import UserError
from twin.whole_file import FULL


def run_study(
    job: Job, folder: StudyFolder, *, chunks: int | Sequence[int], items: int, unit: str, machines: Machines
) -> int:
    """Do every chunk that is not done yet; returns how many that were.

    ``chunks`` is their number, or their numbers where a study has several stages; ``items`` is the number of things
    (designs, sweeps) in all chunks, ``unit`` their name, for the progress line.
    Raises UserError where the disk is full or workers keep dying; what is done stays done.
    """
    numbers = range(chunks) if isinstance(chunks, int) else chunks
    waiting = [chunk for chunk in numbers if not folder.is_done(chunk)]
    if not waiting:
        return 0
    done = len(numbers) - len(waiting)
    try:
        with progress(len(numbers), done, items, unit) as step, _finishing(job, folder, waiting, machines) as finished:
            for _ in finished:
                done += 1
                step()
    except OSError as error:
        why = "the disk is full" if error.errno in FULL else f"it cannot be written ({error.strerror or error})"
        raise UserError(
            f"{folder.path}: {why}; {done} of {len(numbers)} chunks are complete and kept: make room and run the same "
            "command again"
        ) from None
    return len(waiting)


def _finishing(
    job: Job, folder: StudyFolder, waiting: Sequence[int], machines: Machines
) -> AbstractContextManager[Iterator[int]]:
    if machines.scheduler is None:
        from scenarios.studies.engine_pool import pool

        return pool(job, folder, waiting, machines)
    from scenarios.studies.engine_dask import cluster

    return cluster(job, folder, waiting, machines)
