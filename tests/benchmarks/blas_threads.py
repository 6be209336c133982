"""CPU time of ``explain`` called from Python, as it is and with BLAS left on as many threads as it takes by itself.

``python -m tests.benchmarks.blas_threads [SWEEP]``: the least of three runs of each, in processes of their own that do
not say how many threads to use, on the bench sweep if no other is given.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

BENCH_SWEEP = Path(__file__).parents[2] / "scenarios" / "data" / "bench_sweep.csv"
RUNS = 3
MEASURED = """
import contextlib, sys, time
import diagnosis.blas_threads
if sys.argv[2] == "as many as BLAS takes":
    diagnosis.blas_threads.one_blas_thread = contextlib.nullcontext
from diagnosis import explain
explain(sys.argv[1])  # once, so that nothing is imported within the time
start = time.perf_counter(), time.process_time()
explain(sys.argv[1])
print(time.process_time() - start[1], time.perf_counter() - start[0])
"""
"""A script: sweep and limit in, CPU time and time [s] of one call out."""


def times_s(sweep: Path, limit: str) -> tuple[float, float]:
    """Least CPU time and least time [s] of one call."""
    free = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    command = [sys.executable, "-c", MEASURED, str(sweep), limit]
    runs = [
        tuple(map(float, subprocess.run(command, env=free, stdout=subprocess.PIPE, check=True).stdout.split()))
        for _ in range(RUNS)
    ]
    return min(run[0] for run in runs), min(run[1] for run in runs)


def main(sweep: Path) -> None:
    """Print both times with and without the limit, and their ratios."""
    cpu, time = times_s(sweep, "one thread")
    cpu_free, time_free = times_s(sweep, "as many as BLAS takes")
    print(f"{os.cpu_count()} cores; one thread: {cpu:.2f} s of CPU in {time:.2f} s")
    print(f"as many as BLAS takes: {cpu_free:.2f} s of CPU in {time_free:.2f} s")
    print(f"ratio: {cpu_free / cpu:.1f} times the CPU, {time_free / time:.1f} times the time")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else BENCH_SWEEP)
