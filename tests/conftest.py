"""For every test: numerical libraries on one thread, as the command line has them, and which tests are asked for.

Long studies are left out unless the marker expression asks for them (``-m study``). Tests of measured data are left out
where these are absent, all but one, which says so.

``pytest -n auto`` spreads the tests over processes. Each is handed whole files, so that what the tests of a file share
is computed once.
"""

from __future__ import annotations

import os
import signal
import sys
import time
import warnings
from typing import TYPE_CHECKING, Any

import pytest

from tests.measured import DATA

if TYPE_CHECKING:
    from xdist.scheduler import LoadFileScheduling

if "numpy" in sys.modules and "OPENBLAS_NUM_THREADS" not in os.environ:
    warnings.warn(
        "a plugin of pytest imported numpy before its threads were limited, so the tests take several times the CPU: "
        "run with OPENBLAS_NUM_THREADS=1, or without the plugin (-p no:NAME)",
        stacklevel=1,
    )
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Answers bear the day; a run of the tests may last beyond midnight.
os.environ.setdefault("SOURCE_DATE_EPOCH", str(int(time.time())))
# A shell lets what it runs in the background ignore Ctrl-C; tests send it to themselves.
signal.signal(signal.SIGINT, signal.default_int_handler)

MOST_WORKERS = 4
"""More gain little: one file, that of the measured sweeps, takes a quarter of the whole."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """One process for each core that this one may use, which in a container is fewer than there are."""
    allowed = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(allowed, MOST_WORKERS)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> LoadFileScheduling:
    """Whole files, in the order of :func:`pytest_collection_modifyitems`."""
    from xdist.scheduler import LoadFileScheduling

    config.option.loadscopereorder = False
    return LoadFileScheduling(config, log)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is not asked for or cannot run."""
    left_out: list[pytest.Item] = []
    if "study" not in str(config.getoption("markexpr")):
        left_out += [item for item in items if item.get_closest_marker("study")]
    asked = [item for item in items if item.get_closest_marker("measured") and item not in left_out]
    if asked and not DATA.is_dir():
        reason = f"there are no measured sweeps at {DATA}: {len(asked)} tests need them"
        asked[0].add_marker(pytest.mark.skip(reason=reason))
        left_out += asked[1:]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        gone = set(left_out)
        items[:] = [item for item in items if item not in gone]
    # The longest first: begun last, they would keep one process at work when the others have done.
    items.sort(key=lambda item: item.get_closest_marker("measured") is None)
