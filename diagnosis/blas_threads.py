"""What a diagnosis computes with: one thread for its linear algebra, and numpy's own way with what overflows.

Its matrices are small, and threads cost more than they bring.
"""

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
_NUMPYS_OWN: Any = {"divide": "warn", "over": "warn", "under": "ignore", "invalid": "warn"}
"""Where the caller has numpy raise, an exponential that vanishes would end the search."""


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Run the body with BLAS on one thread and numpy's own error handling; afterwards both are as before.

    Calls may be nested and may run in several threads of Python at once.
    """
    import numpy as np

    _LIMIT.hold()
    try:
        with np.errstate(**_NUMPYS_OWN):
            yield
    finally:
        _LIMIT.release()
