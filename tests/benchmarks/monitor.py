"""What ``halltwin monitor`` makes of series whose drift is known: whether it is seen, since when, and false alarms.

``python -m tests.benchmarks.monitor [SERIES]``: series of 40 sweeps there and back, 60 points a turn, noise of 0.02
deg; from sweep 21 on nothing changes, or the gain ratio, the zero or the lag steps or creeps by so many standard
deviations of what is fitted to one sweep.
"""

from __future__ import annotations

import sys

import numpy as np

from diagnosis.factors.control_chart import BOTH, Chart
from diagnosis.factors.series import monitor
from twin import Motion
from twin.angles import TAU
from twin.chain import Chain as Twin

SWEEPS, FIRST = 40, 20
WAY = TAU * np.arange(60) / 60
MOTION = Motion.from_angle(np.concatenate([WAY, WAY[::-1]]))
SIZES = {"gain_ratio": 9e-5, "zero_deg": 2.6e-3, "lag_deg": 2.6e-3}
"""By the factor: the standard deviation of its value in one such sweep."""


def series(factor: str, course: np.ndarray, seed: int) -> tuple[Chart, ...]:
    """The charts of a series in which a factor follows a course (sweeps,), in standard deviations."""
    change = {name: SIZES[name] * course if name == factor else np.zeros(SWEEPS) for name in SIZES}
    sweeps = []
    for k in range(SWEEPS):
        sensor = (
            Twin()
            .with_effect("offset", x_percent=0.8, y_percent=-0.5)
            .with_effect("zero", zero_deg=20.0 + change["zero_deg"][k])
            .with_effect("gain_mismatch", ratio=1.01 + change["gain_ratio"][k])
            .with_effect("hysteresis", lag_deg=0.1 + change["lag_deg"][k], memory_deg=3.0)
            .with_effect("noise", rms_deg=0.02)
        )
        sweeps.append(sensor.simulate(MOTION, seed=SWEEPS * seed + k))
    return monitor(sweeps, rng=np.random.default_rng(seed)).charts


def main(count: int = 40) -> None:
    """Print a line for each kind of change."""
    since = np.maximum(np.arange(SWEEPS) - FIRST + 1.0, 0.0)
    for factor in SIZES:
        for shape, course in (("step of 3", 3.0 * (since > 0)), ("ramp of 0.5 a sweep", 0.5 * since)):
            charts = [
                next(one for one in series(factor, course, seed) if (one.name, one.travel) == (factor, BOTH))
                for seed in range(count)
            ]
            seen = [one for one in charts if one.signal is not None and one.signal >= FIRST]
            changes = [one.change for one in seen if one.change is not None]
            held = sum(change.low <= FIRST <= change.high for change in changes)
            wide = np.median([change.high - change.low + 1 for change in changes]) if changes else np.nan
            late = np.median([one.signal - FIRST + 1 for one in seen if one.signal is not None]) if seen else np.nan
            print(
                f"{factor:10} {shape:19}: signalled in {len(seen)} of {count} series, after {late:.0f} sweeps (median);"
                f" the interval of {wide:.0f} sweeps (median) holds the start in {held} of {len(changes)}"
            )
    still = [series("none", np.zeros(SWEEPS), 10_000 + seed) for seed in range(count)]
    alarms = sum(any(one.signal is not None for one in charts) for charts in still)
    print(f"nothing changes: an alarm in {alarms} of {count} series of {SWEEPS} sweeps; 500 sweeps apart on average")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
