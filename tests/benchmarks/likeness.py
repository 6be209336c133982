"""Likeness on sweeps of the generator in ``tests.hidden``: its size where the twin is right, its power where it is not.

    python -m tests.benchmarks.likeness --seed 777 --draws 2

Of the sweeps explained rightly it counts the p-values below 0.05 and 0.01; then it leaves each cause out of the twin,
fits all else anew and counts again, and does the same with white noise in the place of the coloured.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

from diagnosis import explain
from diagnosis.discovery.proof.bootstrap import noise_of
from diagnosis.discovery.proof.predictive_check import PredictiveCheck, likeness
from diagnosis.discovery.result import Discovery
from diagnosis.discovery.search.likelihood_ratio import drop
from tests.hidden.scoring import verdict
from tests.hidden.sets import Job, jobs
from twin.noise.description import Noise
from twin.sweep import Sweep

GROUPS = (("clean_easy", 4), ("clean_hard", 7), ("single", 1), ("single_hard", 1), ("weak", 1), ("pairs", 1))
"""Sets of the study, and how many draws of each label for each of ``--draws``."""


def explained(job: Job, folder: Path) -> tuple[Discovery, bool, bool, float]:
    """What was found, whether it is right, whether the noise was coloured, and the time of it [s of CPU]."""
    hidden = job.draw()
    path = folder / "sweep.csv"
    hidden.write_csv(path)
    sweep = Sweep.read(path)
    started = time.process_time()
    answered = explain(sweep)
    spent = time.process_time() - started
    right = verdict(answered.to_dict(), hidden.truth) == "right"
    return answered.discovery, right, hidden.truth["noise_kind"] in ("ar1", "pink"), spent


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=1)
    options = parser.parse_args()
    right: list[float] = []
    share: list[float] = []
    left_out: list[float] = []
    white: list[float] = []

    def p_of(found: PredictiveCheck | None, into: list[float]) -> None:
        if found is not None:
            into.append(found.p)

    todo = [job for group, each in GROUPS for job in jobs(group, draws=each * options.draws, seed=options.seed)]
    with tempfile.TemporaryDirectory() as folder:
        for job in todo:
            found, ok, coloured, spent = explained(job, Path(folder))
            if not ok:
                continue
            started = time.process_time()
            p_of(likeness(found.fit, rng=np.random.default_rng(0)), right)
            share.append((time.process_time() - started) / spent)
            for key in (cause.keys[0] for cause in found.causes):
                if any(free.key == key for free in found.fit.free):
                    p_of(likeness(drop(found.fit, key), rng=np.random.default_rng(0)), left_out)
            if coloured:
                flat = Noise(rms_rad=noise_of(found.fit).rms_rad)
                p_of(likeness(found.fit, rng=np.random.default_rng(0), noise=flat), white)
    for name, values in (("explained rightly", right), ("a cause left out", left_out), ("white for coloured", white)):
        p = np.array(values)
        print(f"{name:20s} {p.size:4d} sweeps, p < 0.05: {np.sum(p < 0.05):4d}, p < 0.01: {np.sum(p < 0.01):4d}")
    print("deciles of the first:", *np.histogram(right, 10, (0.0, 1.0))[0])
    print(f"share of the time of explain: median {np.median(share):.0%}, largest {max(share):.0%}")


if __name__ == "__main__":
    main()
