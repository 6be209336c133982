"""Sweeps of 360 readings diagnosed a second, 1 to 10,000 at once, and memory: ``python -m tests.benchmarks.batch``."""

from __future__ import annotations

import resource
import time

import numpy as np

from diagnosis.error_model.fit import fit_equal
from diagnosis.error_model.model import Readings
from diagnosis.error_model.search_range import first_box
from twin.angles import TAU, Array

READINGS = 360
NOISE_DEG = 0.02
COUNTS = (1, 10, 100, 1000, 10_000)


def sweeps(count: int, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Parameters (count, 6) drawn from Table 2's ranges, and reference and measured angles (count, n) [rad]."""
    box = first_box(np.zeros(1))
    points = rng.uniform(box.lower[0], box.upper[0], (count, 6))
    points[:, -1] = rng.uniform(-np.pi, np.pi, count)
    reference = np.broadcast_to(TAU * np.arange(READINGS) / READINGS, (count, READINGS))
    x, y = Readings.of(reference, reference).channels(points)
    noise = np.radians(NOISE_DEG) * rng.standard_normal((count, READINGS))
    return points, np.ascontiguousarray(reference), np.arctan2(y, x) + noise


def main() -> None:
    """Time the batches and print them."""
    rng = np.random.default_rng(0)
    _, reference, measured = sweeps(4, rng)
    fit_equal(reference, measured, rng=rng)
    print("sweeps     time [s]   sweeps a second   peak memory of the process [MiB]   largest RMS [deg]")
    for count in COUNTS:
        _, reference, measured = sweeps(count, rng)
        start = time.perf_counter()
        fits = fit_equal(reference, measured, rng=rng)
        seconds = time.perf_counter() - start
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        worst = max(fit.rms_rad for fit in fits)
        print(f"{count:6d}   {seconds:10.3f}   {count / seconds:15.0f}   {peak:32.0f}   {np.degrees(worst):17.4f}")


if __name__ == "__main__":
    main()
