"""Chunks on a pool of worker processes of this machine."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.connection import Connection

from scenarios.studies.job import Job, do_chunk
from scenarios.studies.machines import Machines, single_threaded, unheard_interrupt
from scenarios.studies.study_folder import StudyFolder
from twin.errors import UserError

_AHEAD = 2
"""Chunks handed out for each worker: one to work on, one waiting."""


@contextlib.contextmanager
def pool(job: Job, folder: StudyFolder, waiting: Sequence[int], machines: Machines) -> Iterator[Iterator[int]]:
    """The numbers of the chunks, in the order in which the workers finish them."""
    workers = machines.count
    context = multiprocessing.get_context("spawn")
    # Nothing is ever sent through it. Its end is closed by us or, where we are killed, by the system: workers leave.
    heard, held = context.Pipe(duplex=False)
    with single_threaded():
        executor = ProcessPoolExecutor(
            min(workers, len(waiting)), mp_context=context, initializer=_leave_with_parent, initargs=(heard,)
        )
        try:
            yield _rolling(executor, job, folder, waiting, ahead=_AHEAD * workers)
        except KeyboardInterrupt:
            # A chunk may take minutes, and half of one is worth nothing.
            held.close()
            raise
        finally:
            executor.shutdown(wait=True, cancel_futures=True)
            held.close()
            heard.close()


def _rolling(
    executor: ProcessPoolExecutor, job: Job, folder: StudyFolder, waiting: Sequence[int], *, ahead: int
) -> Iterator[int]:
    """Keep so many chunks handed out; memory does not grow with the number of chunks."""
    queue = iter(waiting)
    running: set[Future[int]] = set()
    try:
        while True:
            for chunk in queue:
                with unheard_interrupt():
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


def _leave_with_parent(heard: Connection) -> None:
    """A worker whose parent is gone, or wants no more of it, ends: it would wait for work forever."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        with contextlib.suppress(EOFError, OSError):
            heard.recv_bytes()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
