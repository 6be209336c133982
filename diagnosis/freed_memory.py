"""Memory that a diagnosis frees and soon needs again: kept by the process."""

from __future__ import annotations

import ctypes
import platform
from functools import cache

_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
"""Names of the two limits in glibc's ``malloc.h``."""
_LARGEST = 4 * 1024 * 1024 * ctypes.sizeof(ctypes.c_long)
"""Bytes: the largest size of an array that glibc comes to keep by itself, ``DEFAULT_MMAP_THRESHOLD_MAX``."""


@cache
def keep_freed_memory() -> None:
    """Have glibc keep what is freed, from now on; with another C library nothing is done.

    What lies free at the end of the heap goes back to the system as soon as it is twice the largest array freed so far,
    and the system clears every page of it anew when the next array is made: a fit's columns are freed and made at every
    step. Set are the largest limits that glibc comes to by itself once a program has freed such an array (mallopt(3)).
    """
    if platform.libc_ver()[0] != "glibc":
        return
    library = ctypes.CDLL(None)
    library.mallopt(_MMAP_THRESHOLD, _LARGEST)
    library.mallopt(_TRIM_THRESHOLD, 2 * _LARGEST)
