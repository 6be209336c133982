"""Linear least squares of few columns, by whichever way keeps the digits."""

from __future__ import annotations

import numpy as np
import pytest

from twin.least_squares import fitted


@pytest.mark.parametrize("arc_rad", [6.3, 1.0, 0.05], ids=["a turn", "a part", "hardly any"])
def test_is_the_singular_values_answer(arc_rad: float) -> None:
    rng = np.random.default_rng(0)
    angle = rng.uniform(0.0, arc_rad, 500)
    columns = np.stack([np.ones(500), np.cos(angle), np.sin(angle), np.cos(2 * angle), np.sin(2 * angle)], axis=1)
    values = 0.3 * np.cos(angle) + 0.01 * rng.standard_normal(500)
    used = rng.uniform(size=500) < 0.9
    values[~used] = np.nan
    expected = np.linalg.lstsq(columns[used], values[used], rcond=None)[0]
    np.testing.assert_allclose(fitted(columns, values, used), expected, rtol=1e-7, atol=1e-9)


def test_of_columns_that_are_one_the_shortest() -> None:
    columns = np.ones((20, 2))
    np.testing.assert_allclose(fitted(columns, np.full(20, 3.0), np.ones(20, dtype=np.bool_)), [1.5, 1.5])
