"""Time and memory of ``halltwin explain``, every cause searched for, from 10^3 to 10^6 rows.

``python -m tests.benchmarks.long_records``: each run in a process of its own, beside one fit of the baseline to the
same rows by scipy's least_squares as it comes (numerical derivatives, started at an ideal sensor).
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from scenarios.commands.protocol import Protocol
from twin.angles import Array, wrap
from twin.chain import Chain
from twin.sweep import Sweep

ROWS = (1_000, 10_000, 100_000, 1_000_000)
TRUTH = {
    "zero": {"zero_deg": 37.0},
    "offset": {"x_percent": 0.75, "y_percent": -0.7},
    "gain_mismatch": {"ratio": 1.0098},
    "phase": {"beta_deg": 0.172},
    "quadratic_nonlinearity": {"q_percent": 0.19},
    "saturation": {"k_percent": 0.9},
    "hysteresis": {"lag_deg": 0.118, "memory_deg": 8.4},
    "noise": {"rms_deg": 0.02},
    "output_quantisation": {"bits": 14},
}


def record(rows: int) -> Sweep:
    """A sweep of so many readings, forth and back, with two hidden causes."""
    points = min(max(rows // 4, 100), 1000)
    motion = Protocol(turns=rows / (2 * points), points=points, both_directions=True, channels=False).motion()
    return Chain(TRUTH).simulate(motion, seed=1)


def peak_mb() -> float:
    """Most memory [MB] that this process has held."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def explained(path: Path) -> str:
    """CPU time [s], peak memory [MB] and what was found."""
    from diagnosis import explain

    start = time.process_time()
    answer = explain(path).to_dict()
    names = "+".join(cause["name"] for cause in answer["causes"])
    return f"{time.process_time() - start} {peak_mb()} {names}"


def baseline_fit(path: Path) -> str:
    """CPU time [s] and peak memory [MB] of one least_squares fit of the paper's model."""
    from scipy.optimize import least_squares

    start = time.process_time()
    sweep = Sweep.read(path)
    angle, measured = np.radians(sweep.reference_deg), np.radians(sweep.measured_deg)

    def residual(p: Array) -> Array:
        x, y = np.cos(angle - p[0]), np.sin(angle - p[0] + p[4])
        x, y = x + p[1] + p[5] * x * x, p[3] * (y + p[5] * y * y) + p[2]
        return wrap(measured - np.arctan2(y, x))

    least_squares(residual, [np.radians(37.0), 0.0, 0.0, 1.0, 0.0, 0.0])
    return f"{time.process_time() - start} {peak_mb()} -"


def alone(task: str, path: Path) -> tuple[float, float, str]:
    """One task in a process of its own."""
    command = [sys.executable, "-m", "tests.benchmarks.long_records", task, str(path)]
    seconds, megabytes, names = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    return float(seconds), float(megabytes), names


def main() -> None:
    """Print the table."""
    print("rows      explain          least_squares   ratio  named")
    with tempfile.TemporaryDirectory() as folder:
        for rows in ROWS:
            path = Path(folder) / f"{rows}.csv"
            record(rows).write(path)
            seconds, megabytes, names = alone("explain", path)
            fit_s, _, _ = alone("fit", path)
            print(f"{rows:8d}  {seconds:6.1f} s {megabytes:5.0f} MB  {fit_s:6.2f} s  {seconds / fit_s:10.1f}  {names}")


if __name__ == "__main__":
    if len(sys.argv) == 3:
        print({"explain": explained, "fit": baseline_fit}[sys.argv[1]](Path(sys.argv[2])))
    else:
        main()
