"""One engine for all studies: numbered chunks of work, on a process pool or a Dask cluster, resumed where they stopped.

A :class:`Job` is a picklable description that computes chunk k and writes it whole or not at all. What a chunk holds
depends on the job and k alone, so who computes it, and how often, does not show in the result. A chunk counts as
done when its mark stands in the study's folder; the mark is written last.
"""

from __future__ import annotations

import contextlib
import errno
import multiprocessing
import os
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Any, Protocol

from scenarios.studies.study_folder import StudyFolder
from twin.errors import UserError

THREADS = (
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)
"""Each worker is one thread: more would fight over the cores, and could change the last bits of a sum."""
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_AHEAD = 2
"""Chunks handed out for each worker: one to work on, one waiting."""


class Job(Protocol):
    """Work in chunks; picklable, and pure: chunk k depends on the job and k alone."""

    def write(self, folder: StudyFolder, chunk: int) -> None:
        """Compute the chunk and write it whole or not at all."""


@dataclass(frozen=True, kw_only=True)
class Machines:
    """Where the work runs. ``scheduler``: None for a process pool, ``local``, or a Dask scheduler's address."""

    workers: int | None = None
    scheduler: str | None = None

    def __post_init__(self) -> None:
        if self.workers is not None and self.workers < 1:
            raise UserError(f"workers is {self.workers}; expected at least 1")

    @property
    def count(self) -> int:
        """Number of local workers: as many as this process may use cores, unless given."""
        if self.workers is not None:
            return self.workers
        usable = getattr(os, "sched_getaffinity", None)
        return len(usable(0)) if usable is not None else os.cpu_count() or 1


def run_study(job: Job, folder: StudyFolder, *, chunks: int, items: int, unit: str, machines: Machines) -> int:
    """Do every chunk that is not done yet; returns how many that were.

    ``items`` is the number of things (designs, sweeps) in all chunks, ``unit`` their name, for the progress line.
    Raises UserError where the disk is full or workers keep dying; what is done stays done.
    """
    waiting = [chunk for chunk in range(chunks) if not folder.is_done(chunk)]
    if not waiting:
        return 0
    done = chunks - len(waiting)
    try:
        with _progress(chunks, done, items, unit) as step, _finishing(job, folder, waiting, machines) as finished:
            for _ in finished:
                done += 1
                step()
    except OSError as error:
        why = "the disk is full" if error.errno in _FULL else f"it cannot be written ({error.strerror or error})"
        raise UserError(
            f"{folder.path}: {why}; {done} of {chunks} chunks are complete and kept: make room and run the same "
            "command again"
        ) from None
    return len(waiting)


def do_chunk(job: Job, folder: StudyFolder, chunk: int) -> int:
    """One chunk, then its mark: what a worker runs."""
    job.write(folder, chunk)
    folder.mark(chunk)
    return chunk


def _finishing(job: Job, folder: StudyFolder, waiting: Sequence[int], machines: Machines) -> Any:
    if machines.scheduler is None:
        return _pool(job, folder, waiting, machines.count)
    from scenarios.studies.engine_dask import cluster

    return cluster(job, folder, waiting, machines)


@contextlib.contextmanager
def _pool(job: Job, folder: StudyFolder, waiting: Sequence[int], workers: int) -> Iterator[Iterator[int]]:
    """Chunks as a process pool finishes them."""
    context = multiprocessing.get_context("spawn")
    with single_threaded():
        pool = ProcessPoolExecutor(min(workers, len(waiting)), mp_context=context, initializer=_leave_with_parent)
        try:
            yield _rolling(pool, job, folder, waiting, _AHEAD * workers)
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _rolling(
    pool: ProcessPoolExecutor, job: Job, folder: StudyFolder, waiting: Sequence[int], ahead: int
) -> Iterator[int]:
    """Keep so many chunks handed out; memory does not grow with the number of chunks."""
    queue = iter(waiting)
    running: set[Future[int]] = set()
    try:
        while True:
            for chunk in queue:
                running.add(pool.submit(do_chunk, job, folder, chunk))
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


@contextlib.contextmanager
def single_threaded() -> Iterator[None]:
    """Processes started within use one thread each for linear algebra."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@contextlib.contextmanager
def _progress(chunks: int, done: int, items: int, unit: str) -> Iterator[Any]:
    """A function to call after each chunk: a bar with rate and time left, nothing where stderr is no terminal."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda: None
        return
    columns = (
        TextColumn(unit),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    each = items / chunks
    with Progress(*columns, console=console) as progress:
        task = progress.add_task(unit, total=items, completed=round(done * each), rate="")

        def step() -> None:
            progress.advance(task, each)
            speed = progress.tasks[0].speed
            progress.update(task, rate="" if not speed else f"{speed:,.0f} {unit}/s")

        yield step
