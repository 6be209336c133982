"""How often a cause is named in clean sweeps with noise correlated from reading to reading.

``python -m tests.benchmarks.coloured_noise [SWEEPS]``: clean sweeps from the twin, first-order autoregressive noise of
0.03 deg with 0.6 and 0.9, 72 to 360 points a turn, one to four turns, one or both directions, 12 to 16 bits.
"""

from __future__ import annotations

import sys

import numpy as np

from diagnosis import explain
from twin import Chain, Motion, Sweep
from twin.angles import TAU


def clean_sweep(correlation: float, seed: int) -> Sweep:
    """A sweep that holds nothing but the baseline and coloured noise."""
    rng = np.random.default_rng([int(10 * correlation), seed])
    points, turns = int(rng.choice([72, 90, 120, 180, 360])), int(rng.choice([1, 2, 4]))
    shaft = np.arange(turns * points) * (TAU / points)
    way = np.ones(shaft.size)
    both = bool(rng.integers(0, 2))
    if both:
        shaft, way = np.concatenate([shaft, shaft[::-1]]), np.concatenate([way, -way])
    motion = Motion.from_angle(
        shaft + rng.uniform(0.0, TAU), time_s=0.4 * np.arange(shaft.size), direction=way if both else None
    )
    chain = (
        Chain()
        .with_effect("zero", zero_deg=rng.uniform(0.0, 360.0))
        .with_effect("offset", x_percent=rng.normal(0.0, 1.0), y_percent=rng.normal(0.0, 1.0))
        .with_effect("gain_mismatch", ratio=1.0 + rng.normal(0.0, 0.03))
        .with_effect("phase", beta_deg=rng.normal(0.0, 0.5))
        .with_effect("quadratic_nonlinearity", q_percent=rng.normal(0.0, 0.2))
        .with_effect("noise", rms_deg=0.03, correlation=correlation, correlated_share=1.0)
        .with_effect("output_quantisation", bits=int(rng.choice([12, 14, 16])))
    )
    return chain.simulate(motion, seed=seed)


def main(sweeps: int = 50) -> None:
    """Print for each correlation in how many sweeps a cause was named, and which."""
    for correlation in (0.6, 0.9):
        answers = [explain(clean_sweep(correlation, seed)).causes for seed in range(sweeps // 2)]
        named = [[cause.name for cause in causes] for causes in answers if causes]
        print(f"AR(1) {correlation}: a cause named in {len(named)} of {len(answers)} clean sweeps {named or ''}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
