"""The family-wise probability on clean sweeps: even, if it is what it says; the F test's beside it.

    python -m tests.benchmarks.family_wise --seed 41 --sweeps 200

The sweeps are clean draws of the generator in ``tests.hidden``. On each, every effect is screened, and the best one's
probability is taken: calibrated on simulated sweeps, and as the F test gives it for so many effects.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

from diagnosis import explain
from diagnosis.discovery.fitting.joint_fit import Fit, solve
from diagnosis.discovery.proof.bootstrap import noise_of
from diagnosis.discovery.proof.family_wise import family_wise
from diagnosis.discovery.search.likelihood_ratio import settle, take_out
from diagnosis.discovery.search.screening import Base, screen
from tests.hidden.generator import draw
from twin.catalogue import CATALOGUE

LEVELS = (0.2, 0.1, 0.05, 0.02, 0.01)


def baseline_of(seed: int, bench: str) -> Fit:
    """The fitted baseline of a clean draw, whatever was found in it taken out."""
    hidden = draw([], seed=seed, bench=bench)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sweep.csv"
        hidden.write_csv(path)
        found = explain(path).discovery
    fit = found.fit
    free = {one.key for one in found.baseline.free}
    for key in sorted({one.key for one in fit.free} - free):
        fit = take_out(fit, key)
    return settle(solve(fit))[0]


def smallest(fit: Fit, rng: np.random.Generator) -> tuple[float, float]:
    """Family-wise probability of the effect that stands out most: calibrated, and by the F test."""
    provides = fit.observations.motion.provides
    effects = [e for e in CATALOGUE if not e.baseline and e.footprint == "mean" and e.visible_in(provides)]
    family = family_wise(fit, fit, noise_of(fit), effects, rng=rng)
    found = screen(Base.of(fit), effects)
    calibrated = min((family.log_p(one.effect.name, one.log_p) for one in found), default=0.0)
    plain = min((one.log_p for one in found), default=0.0) + np.log(len(effects))
    return float(np.exp(calibrated)), float(np.exp(min(plain, 0.0)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--sweeps", type=int, default=100)
    options = parser.parse_args()
    print("bench  sweeps  p below:", *(f"{level:>14g}" for level in LEVELS))
    for bench in ("easy", "hard"):
        seeds = np.random.default_rng([options.seed, bench == "hard"]).integers(2**31, size=options.sweeps)
        p = np.array([smallest(baseline_of(int(s), bench), np.random.default_rng(int(s))) for s in seeds])
        for place, label in enumerate(("simulated", "F test")):
            counts = [int(np.count_nonzero(p[:, place] < level)) for level in LEVELS]
            print(
                f"{bench}   {options.sweeps:6d}  {label:>9}", *(f"{c:>6d} ({c / options.sweeps:.3f})" for c in counts)
            )


if __name__ == "__main__":
    main()
