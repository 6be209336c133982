"""CPU time of ``halltwin explain`` on the bench sweep, as a multiple of importing scipy.optimize.

``python -m tests.benchmarks.explain_cpu``: the least of five runs of each, in processes of their own.
"""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

BENCH_SWEEP = Path(__file__).parents[2] / "scenarios" / "data" / "bench_sweep.csv"


def cpu_s(*arguments: str) -> float:
    """Least CPU time [s] of five runs of Python with these arguments."""
    times = []
    for _ in range(5):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(times)


def main() -> None:
    """Print the two times and their ratio."""
    imported = cpu_s("-c", "import scipy.optimize")
    explained = cpu_s("-m", "scenarios.cli.main", "explain", str(BENCH_SWEEP))
    print(f"explain {explained:.2f} s, import scipy.optimize {imported:.2f} s: {explained / imported:.1f} times")


if __name__ == "__main__":
    main()
