"""Where a study's work runs: how many worker processes, or which Dask cluster, each worker on one thread."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from multiprocessing import resource_tracker

from twin.errors import UserError

THREADS = (
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)
"""Each worker is one thread: more would fight over the cores, and could change the last bits of a sum."""


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
def unheard_interrupt() -> Iterator[None]:
    """Processes and threads started within never hear of Ctrl-C, which is the parent's to answer, afterwards."""
    if sys.platform == "win32":
        yield
        return
    # Whoever starts it lets interrupts through again.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
