"""``python -m tests.diagnosis.factors.gap_study``: what comes back of known causes over three air gaps.

For each case: how often the causes named are right, too many or too few, or none of them; the displacements' bias, and
how many of their 95 % intervals hold the truth. Stated gaps are off by their standard uncertainty of 0.05 mm.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field

import numpy as np

from diagnosis import Mounting, diagnose_many
from diagnosis.factors.air_gaps import AirGaps
from diagnosis.factors.displacement import Displacement, magnet_displacement, sensor_displacement
from tests.diagnosis.factors.gap_sweeps import CASES, Truth

GAPS_MM = (1.0, 2.0, 3.0)


def asked(truth: Truth, seed: int, *, channels: bool, gaps_mm: tuple[float, ...] = GAPS_MM) -> AirGaps | None:
    """The joint fit of sweeps at these gaps; with channels only the first one is stated, else each."""
    rng = np.random.default_rng(seed)
    mounting = Mounting(air_gap_mm=gaps_mm[:1] if channels else gaps_mm)
    true = np.array(gaps_mm) + mounting.gap_error_mm * rng.standard_normal(len(gaps_mm))
    sweeps = [truth.sweep(float(gap), rng, channels=channels) for gap in true]
    return diagnose_many(sweeps, output_sense=1, mounting=mounting).air_gap_fit


@dataclass
class Tally:
    """Counts of one case."""

    right: int = 0
    wrong: int = 0
    less: int = 0
    misfits: int = 0
    errors_mm: dict[str, list[float]] = field(default_factory=lambda: {"sensor": [], "magnet": []})
    held: dict[str, int] = field(default_factory=lambda: {"sensor": 0, "magnet": 0})

    def add(self, found: AirGaps, truth: Truth, causes: frozenset[str]) -> None:
        """Count one answer."""
        named = set(found.named)
        self.misfits += found.misfit
        self.right += named == causes
        self.wrong += bool(named - causes)
        self.less += named < causes
        for name, told in (("sensor", sensor_displacement), ("magnet", magnet_displacement)):
            self._measured(name, told(found.best) if name in named else None, abs(getattr(truth, name)))

    def _measured(self, name: str, found: Displacement | None, true_mm: float) -> None:
        if found is not None:
            self.errors_mm[name].append(found.mm - true_mm)
            self.held[name] += found.low_mm <= true_mm <= found.high_mm


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--case", action="append", choices=list(CASES))
    options = parser.parse_args()
    print(f"{'case':32}{'channels':>9}{'right':>7}{'wrong':>7}{'less':>6}{'misfit':>8}   displacement: bias, sd, held")
    for name in options.case or CASES:
        truth, causes = CASES[name]
        for channels in (True, False):
            tally = Tally()
            for seed in range(options.seeds):
                found = asked(truth, seed, channels=channels)
                assert found is not None
                tally.add(found, truth, causes)
            said = "; ".join(
                f"{which} {np.mean(errors):+.4f} mm, {np.std(errors):.4f} mm, {tally.held[which]}/{len(errors)}"
                for which, errors in tally.errors_mm.items()
                if errors
            )
            counts = f"{tally.right:7d}{tally.wrong:7d}{tally.less:6d}{tally.misfits:8d}"
            print(f"{name:32}{'yes' if channels else 'no':>9}{counts}   {said}", flush=True)


if __name__ == "__main__":
    main()
