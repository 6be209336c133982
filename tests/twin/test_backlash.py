"""The play operator: a trembling shaft is followed reading by reading, to the same bits as stretch by stretch."""

from __future__ import annotations

import numpy as np
import pytest

from twin.mechanics.backlash import play


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("seed", range(8))
def test_one_width_and_a_batch_of_widths_give_the_same(seed: int, way: float) -> None:
    rng = np.random.default_rng(seed)
    shaft = np.cumsum(rng.standard_normal(300)) if seed % 2 else rng.standard_normal(300)
    widths = np.abs(rng.standard_normal(3))
    together = play(shaft, widths[:, None], way=way)
    for width, row in zip(widths, together, strict=True):
        assert np.array_equal(play(shaft, np.array([width]), way=way), row)
        # Never farther from the shaft than the dead zone reaches.
        assert np.max(np.abs(row - shaft)) <= width * (1.0 + 1e-12)
