"""Intervals of displacements, tilts, their products and directions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.factors.displacement import Displacement, hull, upright_product
from diagnosis.factors.modulus import modulus_interval
from tests.diagnosis.factors.gap_study import of_twin
from twin.magnet.magnet import Magnet


def test_the_interval_of_a_product_holds_what_its_law_neglects() -> None:
    """A magnet 0.3 mm off changes the offset by 0.9 % more than in proportion, three standard errors of the product.

    Of five draws two or more outside 95 % intervals are a chance of 2 %.
    """
    true, inside = float(np.hypot(4.0, 2.0)) * 0.3, 0
    for seed in range(5):
        tilted = {"sensor_tilt_x_deg": 4.0, "sensor_tilt_y_deg": 2.0, "magnet_x_mm": 0.3}
        found = of_twin((1.0, 2.0, 3.0), True, first_seed=10 * seed, **tilted)
        product = upright_product(found.best, "tilt_and_magnet", magnet=Magnet())
        assert product is not None
        inside += product.low < true < product.high
        # And is not wider by more than what the magnet's field neglects on either side.
        assert product.high - product.low < 0.05 * true
    assert inside >= 4


def test_directions_of_one_period_are_close_across_its_end() -> None:
    """A displacement towards 89 degrees or its opposite is 2 degrees off one towards -89; a magnet's is 178 off."""
    off_axis = [Displacement(0.5, 0.45, 0.55, way * 89.0, 2.0, period_deg=180.0) for way in (1.0, -1.0)]
    assert hull(off_axis).direction_half_deg == pytest.approx(4.0)
    magnets = [replace(one, period_deg=360.0) for one in off_axis]
    assert hull(magnets).direction_half_deg == pytest.approx(180.0)
    crossed = [off_axis[0], replace(off_axis[0], direction_deg=0.0, direction_half_deg=5.0)]
    assert hull(crossed).direction_half_deg == 180.0


@pytest.mark.parametrize("true", [0.0, 0.5, 1.5, 3.0, 20.0])
def test_the_interval_of_a_length_holds_it_in_95_of_100(true: float) -> None:
    """4000 draws: the share scatters by 0.35 %. Where none at all is possible one limit cannot be missed: 97.5 %."""
    rng = np.random.default_rng(1)
    drawn = np.hypot(true + rng.standard_normal(4000), rng.standard_normal(4000))
    ends = [modulus_interval(float(length), 1.0) for length in drawn]
    held = np.mean([low <= true <= high for low, high in ends])
    assert held >= 0.95 - 4 * 0.0035
    if true >= 3.0:
        assert held <= 0.95 + 4 * 0.0035
    assert all(low <= length <= high for length, (low, high) in zip(drawn, ends, strict=True))
