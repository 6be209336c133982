"""The guide's sweep with an effect that no catalogue has: a gear on the shaft.

    python -m tests.hidden.gear_sweep -o scenarios/data/gear_sweep.csv

A pinion of 13 teeth sits between the reference encoder and the magnet. Each tooth that takes over the load twists the
shaft a little, and the other flank, which carries the load on the way back, twists it less. Independent of the twin:
numpy and the standard library only.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

TEETH = 13
FORWARD_DEG, BACKWARD_DEG, PHASE_DEG = 0.11, 0.03, 40.0
NOISE_DEG = 0.015
BITS = 14


def columns() -> dict[str, np.ndarray]:
    """Two turns there and back, stopped at every degree: the columns of the sweep file, (1440,) each."""
    rng = np.random.default_rng(13)
    there = np.arange(720.0)
    reference = np.concatenate([there, there[::-1]])
    direction = np.repeat([1.0, -1.0], there.size)
    twist = np.where(direction > 0.0, FORWARD_DEG, BACKWARD_DEG)
    magnet = reference + twist * np.sin(np.radians(TEETH * reference + PHASE_DEG))
    angle = np.radians(magnet + 71.0)
    x = 0.006 + np.cos(angle) + 0.0015 * np.cos(angle) ** 2
    y = -0.004 + 1.008 * np.sin(angle + np.radians(0.2)) + 0.0015 * np.sin(angle) ** 2
    read = np.degrees(np.arctan2(y, x)) + NOISE_DEG * rng.standard_normal(reference.size)
    step = 360.0 / 2**BITS
    return {
        "time_s": 0.5 * np.arange(reference.size),
        "reference_deg": reference,
        "measured_deg": np.round(read / step) * step % 360.0,
        "direction": direction,
        "turn": np.repeat([0.0, 1.0, 2.0, 3.0], 360),
    }


def main() -> None:
    """Write the sweep file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, required=True)
    made = columns()
    rows = zip(*made.values(), strict=True)
    lines = [",".join(made), *(",".join(f"{value:.9g}" for value in row) for row in rows)]
    parser.parse_args().output.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
