"""Chunks on a pool of worker processes of this machine."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool

from scenarios.studies.job import Job, do_chunk
from scenarios.studies.machines import Machines, single_threaded
from scenarios.studies.study_folder import StudyFolder
from twin.errors import UserError

_AHEAD = 2
"""Chunks handed out for each worker: one to work on, one waiting."""


@contextlib.contextmanager
def pool(job: Job, folder: StudyFolder, waiting: Sequence[int], machines: Machines) -> Iterator[Iterator[int]]:
    """The numbers of the chunks, in the order in which the workers finish them."""
    workers = machines.count
    context = multiprocessing.get_context("spawn")
    with single_threaded():
        executor = ProcessPoolExecutor(min(workers, len(waiting)), mp_context=context, initializer=_leave_with_parent)
        try:
            yield _rolling(executor, job, folder, waiting, ahead=_AHEAD * workers)
        finally:
            executor.shutdown(wait=True, cancel_futures=True)


def _rolling(
    executor: ProcessPoolExecutor, job: Job, folder: StudyFolder, waiting: Sequence[int], *, ahead: int
) -> Iterator[int]:
    """Keep so many chunks handed out; memory does not grow with the number of chunks."""
    queue = iter(waiting)
    running: set[Future[int]] = set()
    try:
        while True:
            for chunk in queue:
                running.add(executor.submit(do_chunk, job, folder, chunk))
                if len(running) >= ahead:
                    break
            if not running:
                return
            ready, running = wait(running, return_when=FIRST_COMPLETED)
            for future in ready:
                yield future.result()
    except BrokenProcessPool:
        raise UserError(
            f"{folder.path}: a worker process was killed (out of memory?); run the same command again to go on, "
            "with fewer --workers if it happens again"
        ) from None


def _leave_with_parent() -> None:
    """A worker whose parent was killed ends too: it would wait for work forever."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
