"""Readings that were chosen, as a table's index is, are told from those of a sensor with few codes."""

from __future__ import annotations

import numpy as np
import pytest

from twin.reading_grid import step_of_grid_deg
from twin.sweep import Sweep


def error_deg(angle_deg: np.ndarray) -> np.ndarray:
    return 0.8 * np.sin(np.radians(angle_deg + 30.0)) + 0.3 * np.sin(np.radians(2.0 * angle_deg))


@pytest.mark.parametrize("entries", [32, 64, 200, 1024])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_the_index_of_a_table_is_a_grid(entries: int, sense: float) -> None:
    grid = 360.0 / entries * np.arange(entries)
    read = Sweep.from_columns({"reference_deg": sense * (grid - error_deg(grid)) % 360.0, "measured_deg": grid})
    assert read.reading_grid_deg == pytest.approx(360.0 / entries)
    assert read.part(np.arange(10)).reading_grid_deg == pytest.approx(360.0 / entries)


@pytest.mark.parametrize("codes", [32, 64, 200, 1024])
def test_a_sensor_of_few_codes_has_none(codes: int) -> None:
    """Whether it is read at as many even angles as it has codes, at uneven ones, or at many."""
    rng = np.random.default_rng(codes)
    step = 360.0 / codes
    even = step * (np.arange(codes) + 0.3)
    for shaft in (even, even + rng.uniform(-0.4, 0.4, codes) * step, np.linspace(0.0, 360.0, 7 * codes)):
        assert step_of_grid_deg(np.round((shaft + error_deg(shaft)) / step) * step % 360.0, shaft) is None


def test_readings_that_came_out_are_none() -> None:
    shaft = np.arange(0.0, 360.0, 3.0)
    assert step_of_grid_deg(shaft + error_deg(shaft), shaft) is None
    assert step_of_grid_deg(shaft, shaft) is None
