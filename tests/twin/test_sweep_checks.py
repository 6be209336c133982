"""Readings that follow but for a bit of their word make a sweep; those that do not follow at all make none."""

from __future__ import annotations

import numpy as np
import pytest

from twin.errors import SweepError
from twin.sweep import Sweep


@pytest.mark.parametrize("bit", [13, 12])
@pytest.mark.parametrize("stands_at", [0, 1])
@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("rows", [20, 40, 360])
def test_a_word_whose_high_bit_always_reads_the_same_is_a_sweep(
    bit: int, stands_at: int, sense: float, rows: int
) -> None:
    """It reads half a turn only, which is no angle in radians."""
    shaft = np.linspace(3.0, 360.0, rows)
    word = np.round(np.mod(sense * shaft + 71.0 + 0.8 * np.sin(np.radians(shaft)), 360.0) / 360.0 * 16384).astype(int)
    word = word % 16384 & ~(1 << bit) | stands_at << bit
    assert len(Sweep.from_columns({"reference_deg": shaft, "measured_deg": word * 360.0 / 16384})) == rows


def test_readings_at_random_in_half_a_turn_are_no_sweep() -> None:
    """Half of 40 rows within 20 deg of twice the angle: by chance less than once in ten million."""
    rng = np.random.default_rng(3)
    for _ in range(300):
        readings = {
            "reference_deg": np.sort(rng.uniform(0.0, 360.0, 40)),
            "measured_deg": rng.uniform(180.0, 360.0, 40),
        }
        with pytest.raises(SweepError, match=r"does not follow|agree only|turns"):
            Sweep.from_columns(readings)
