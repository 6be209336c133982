"""Chunks on a Dask distributed cluster (extra ``sweeps``).

The workers write their chunks themselves, so a cluster of several machines needs a file system they share.
"""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

from scenarios.studies.job import Job, do_chunk
from scenarios.studies.machines import Machines, single_threaded, unheard_interrupt
from scenarios.studies.study_folder import StudyFolder
from twin.errors import UserError

_AHEAD = 3
"""Chunks handed out for each worker: the scheduler is further away than a pool's queue."""
_CONNECT_S = 10.0


@contextlib.contextmanager
def cluster(job: Job, folder: StudyFolder, waiting: Sequence[int], machines: Machines) -> Iterator[Iterator[int]]:
    """Chunks as the cluster finishes them; a chunk whose worker died is given to another one."""
    with single_threaded(), _client(machines) as client:
        yield _rolling(client, job, folder, waiting)


@contextlib.contextmanager
def _client(machines: Machines) -> Iterator[Any]:
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise UserError("--scheduler needs Dask; pip install '.[sweeps]' in the checkout") from None
    if machines.scheduler != "local":
        try:
            client = Client(machines.scheduler, timeout=_CONNECT_S)
        except (OSError, ValueError) as error:
            raise UserError(
                f"--scheduler {machines.scheduler}: no Dask scheduler answers there ({type(error).__name__}); "
                "give local, or an address such as tcp://host:8786"
            ) from None
        with client:
            yield client
        return
    with unheard_interrupt():
        local = LocalCluster(n_workers=machines.count, threads_per_worker=1, dashboard_address="127.0.0.1:0")
    with local, Client(local) as client:
        try:
            yield client
        except KeyboardInterrupt:
            # What Dask has to say about its workers' end is of no use to anyone.
            logging.getLogger("distributed").setLevel(logging.CRITICAL)
            raise


def _rolling(client: Any, job: Job, folder: StudyFolder, waiting: Sequence[int]) -> Iterator[int]:
    """Keep some chunks handed out for each worker, so that neither memory nor the scheduler grows with their number."""
    from distributed import KilledWorker, as_completed

    queue = iter(waiting)
    ahead = max(_AHEAD * len(client.scheduler_info()["workers"]), _AHEAD)
    # The work has side effects: it must neither be merged with an equal one nor be remembered.
    first = [client.submit(do_chunk, job, folder, chunk, pure=False) for chunk in islice(queue, ahead)]
    running = as_completed(first)
    try:
        for future in running:
            yield future.result()
            for chunk in queue:
                running.add(client.submit(do_chunk, job, folder, chunk, pure=False))
                break
    except KilledWorker:
        raise UserError(
            f"{folder.path}: Dask workers keep dying on the same chunk (out of memory?); run the same command again "
            "to go on"
        ) from None
