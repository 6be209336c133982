"""Time and memory of ``halltwin explain``, every cause searched for, from 10^3 to 10^7 rows, as a table of the guide.

``python -m tests.benchmarks.long_records``: each run in a process of its own, beside one fit of the baseline to the
same rows by scipy's least_squares as it comes (numerical derivatives, started at an ideal sensor). The records hold two
causes that any of them shows, and one of a hundredth of the noise, ``WEAK``, that only very many readings do.
"""

from __future__ import annotations

import argparse
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

ROWS = (1_000, 10_000, 100_000, 1_000_000, 10_000_000)
AT_ONCE = 1_000_000
"""Rows that are simulated at once."""
WEAK = {"order": 6.0, "amplitude_deg": 0.0002, "phase_deg": 40.0}
TRUTH = {
    "zero": {"zero_deg": 37.0},
    "offset": {"x_percent": 0.75, "y_percent": -0.7},
    "gain_mismatch": {"ratio": 1.0098},
    "phase": {"beta_deg": 0.172},
    "quadratic_nonlinearity": {"q_percent": 0.19},
    "saturation": {"k_percent": 0.9},
    "hysteresis": {"lag_deg": 0.118, "memory_deg": 8.4},
    "magnet_harmonic": WEAK,
    "noise": {"rms_deg": 0.02},
    "output_quantisation": {"bits": 14},
}


def write(rows: int, path: Path) -> None:
    """Write a record of so many readings, forth and back, with the hidden causes; simulated part by part."""
    points = min(max(rows // 4, 100), 1000)
    motion = Protocol(turns=rows / (2 * points), points=points, both_directions=True, channels=False).motion()
    chain = Chain(TRUTH)
    with path.open("w", encoding="utf-8") as file:
        for start in range(0, len(motion), AT_ONCE):
            # A turn ahead of the part, so that a hysteresis remembers what was before.
            first = max(start - points, 0)
            part = motion.part(np.arange(first, min(start + AT_ONCE, len(motion))))
            columns = chain.simulate(part, seed=1 + start // AT_ONCE).columns | {"turn": part.turn + motion.turn[first]}
            if not start:
                file.write(",".join(columns) + "\n")
            table = np.column_stack(list(columns.values()))[start - first :]
            np.savetxt(file, table, fmt="%.10g", delimiter=",")


def peak_mb() -> float:
    """Most memory [MB] that this process has held."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def explained(path: Path) -> str:
    """CPU time [s], peak memory [MB] and what was found."""
    from diagnosis import explain

    start = time.process_time()
    answer = explain(path).to_dict()
    names = "+".join(cause["name"] for cause in answer["causes"])
    beside = "+".join(cause["name"] for cause in answer.get("whole_record", {}).get("causes", ()))
    return f"{time.process_time() - start} {peak_mb()} {names or '-'} {beside or '-'}"


def written(path: Path) -> str:
    """CPU time [s] and peak memory [MB] of writing the record whose rows the file's name says."""
    start = time.process_time()
    write(int(path.stem), path)
    return f"{time.process_time() - start} {peak_mb()} - -"


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
    return f"{time.process_time() - start} {peak_mb()} - -"


def alone(task: str, path: Path) -> tuple[float, float, str, str]:
    """One task in a process of its own; the most memory that a parent has held would count as the child's."""
    command = [sys.executable, "-m", "tests.benchmarks.long_records", "--task", task, "--path", str(path)]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    seconds, megabytes, names, beside = told
    return float(seconds), float(megabytes), names, beside


def main() -> None:
    """Print the table, or one task's figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, nargs="+", default=list(ROWS))
    parser.add_argument("--task", choices=("write", "explain", "fit"), help="one task alone, for --path")
    parser.add_argument("--path", type=Path)
    options = parser.parse_args()
    if options.task:
        print({"write": written, "explain": explained, "fit": baseline_fit}[options.task](options.path))
        return
    print("| rows | CPU, s | memory, MB | one least_squares fit, s | times as long | named | beside, by all readings |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for rows in options.rows:
            path = Path(folder) / f"{rows}.csv"
            alone("write", path)
            seconds, megabytes, names, beside = alone("explain", path)
            fit_s = alone("fit", path)[0]
            path.unlink()
            figures = f"{seconds:.1f} | {megabytes:.0f} | {fit_s:.3g} | {seconds / fit_s:.3g}"
            print(f"| {rows:,} | {figures} | {names} | {beside} |", flush=True)


if __name__ == "__main__":
    main()
