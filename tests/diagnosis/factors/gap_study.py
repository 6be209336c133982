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
from diagnosis.factors.displacement import MEASURED, Displacement
from tests.diagnosis.factors.gap_sweeps import CASES, Truth
from twin.chain import Chain
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.motion import Motion

GAPS_MM = (1.0, 2.0, 3.0)


def asked(truth: Truth, seed: int, *, channels: bool, gaps_mm: tuple[float, ...] = GAPS_MM) -> AirGaps | None:
    """The joint fit of sweeps at these gaps; with channels only the first one is stated, else each."""
    rng = np.random.default_rng(seed)
    mounting = Mounting(air_gap_mm=gaps_mm[:1] if channels else gaps_mm)
    true = np.array(gaps_mm) + mounting.gap_error_mm * rng.standard_normal(len(gaps_mm))
    sweeps = [truth.sweep(float(gap), rng, channels=channels) for gap in true]
    return diagnose_many(sweeps, output_sense=1, mounting=mounting).air_gap_fit


def of_twin(gaps_mm: tuple[float, ...], channels: bool, *, first_seed: int = 0, **placed: float) -> AirGaps:
    """What the fit says of a twin of this placement, at these gaps."""
    motion = Motion.from_angle(np.radians(np.arange(0.0, 360.0)), has_channels=channels)
    sweeps = []
    for seed, gap in enumerate(gaps_mm, first_seed):
        device = Chain(magnet=Assembly(Magnet(), Placement(air_gap_mm=gap, **placed)))
        made = device.with_effect("noise", rms_deg=0.02).simulate(motion, seed=seed)
        columns = {"reference_deg": made.reference_deg, "measured_deg": made.measured_deg}
        if channels:
            columns |= {"vx": np.asarray(made.vx), "vy": np.asarray(made.vy)}
        sweeps.append(columns)
    found = diagnose_many(sweeps, output_sense=1, mounting=Mounting(air_gap_mm=gaps_mm)).air_gap_fit
    assert found is not None
    return found


@dataclass
class Tally:
    """Counts of one case."""

    right: int = 0
    wrong: int = 0
    less: int = 0
    misfits: int = 0
    errors: dict[str, list[float]] = field(default_factory=lambda: {name: [] for name in MEASURED})
    held: dict[str, int] = field(default_factory=lambda: dict.fromkeys(MEASURED, 0))

    def add(self, found: AirGaps, truth: Truth, causes: frozenset[str]) -> None:
        """Count one answer."""
        named = set(found.named)
        self.misfits += found.misfit
        self.right += named == causes
        self.wrong += bool(named - causes)
        self.less += named < causes
        for name in MEASURED:
            self._measured(name, found.displaced(name), abs(getattr(truth, name)))

    def _measured(self, name: str, found: Displacement | None, true: float) -> None:
        if found is not None:
            self.errors[name].append(found.value - true)
            self.held[name] += found.low <= true <= found.high


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--gaps", default="1,2,3", help="stated air gaps in mm")
    parser.add_argument("--case", action="append", choices=list(CASES))
    options = parser.parse_args()
    gaps = tuple(map(float, options.gaps.split(",")))
    print(f"{'case':32}{'channels':>9}{'right':>7}{'wrong':>7}{'less':>6}{'misfit':>8}   bias, sd [mm, deg], held")
    for name in options.case or CASES:
        truth, causes = CASES[name]
        for channels in (True, False):
            tally = Tally()
            for seed in range(options.seeds):
                found = asked(truth, seed, channels=channels, gaps_mm=gaps)
                assert found is not None
                tally.add(found, truth, causes)
            said = "; ".join(
                f"{which} {np.mean(errors):+.4f}, {np.std(errors):.4f}, {tally.held[which]}/{len(errors)}"
                for which, errors in tally.errors.items()
                if errors
            )
            counts = f"{tally.right:7d}{tally.wrong:7d}{tally.less:6d}{tally.misfits:8d}"
            print(f"{name:32}{'yes' if channels else 'no':>9}{counts}   {said}", flush=True)


if __name__ == "__main__":
    main()
