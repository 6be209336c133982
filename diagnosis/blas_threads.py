"""One thread for the linear algebra of a diagnosis: its matrices are small, and threads cost more than they bring."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class _Limit:
    """The limit that is in force, and by how many calls: the number of threads belongs to the whole process."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._holders = 0
        self._limits: Any = None

    def hold(self) -> None:
        """Set one thread, unless another call has done so."""
        # SciPy brings a BLAS of its own, which can be limited only once it is loaded.
        import scipy.special  # noqa: F401
        from threadpoolctl import threadpool_limits

        with self._lock:
            if self._holders == 0:
                self._limits = threadpool_limits(1, user_api="blas")
            self._holders += 1

    def release(self) -> None:
        """The last call to end restores what was set before the first."""
        with self._lock:
            self._holders -= 1
            if self._holders == 0:
                self._limits.restore_original_limits()
                self._limits = None


_LIMIT = _Limit()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Run the body with BLAS on one thread; afterwards it has as many as before.

    Calls may be nested and may run in several threads of Python at once.
    """
    _LIMIT.hold()
    try:
        yield
    finally:
        _LIMIT.release()
