"""What is freed is kept: no page is cleared anew for arrays that are made and freed again and again."""

from __future__ import annotations

import platform
import subprocess
import sys

import pytest

_FAULTS = """
import resource
import numpy as np
from diagnosis.blas_threads import one_blas_thread

def cleared(times):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(times):
        arrays = [np.ones(150_000) for _ in range(4)]
        del arrays
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before

usual = cleared(10)
with one_blas_thread():
    cleared(1)
    print(usual, cleared(10))
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other C libraries have no such limits")
def test_what_a_diagnosis_frees_is_not_cleared_anew() -> None:
    done = subprocess.run([sys.executable, "-c", _FAULTS], capture_output=True, text=True, check=True)
    usual, kept = map(int, done.stdout.split())
    # Four arrays of 1.2 MB are 1,172 pages of 4 KiB, each time.
    assert usual > 10_000
    assert kept < 100
