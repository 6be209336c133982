"""How freely a shaft may have moved beside an estimate: kept through parts, averages and joined recordings."""

from __future__ import annotations

import numpy as np
import pytest

from twin.estimated_motion import EstimatedMotion, Torque


def motion(rows: int = 12, stretches: int = 2) -> EstimatedMotion:
    stretch = np.repeat(np.arange(stretches), rows // stretches)
    return EstimatedMotion(stretch=stretch, knee_rad=np.full(rows, 0.5), noise_rad=1e-3, torques=(Torque(order=1),))


def test_a_stretch_ends_where_rows_are_left_out() -> None:
    part = motion().part(np.array([0, 1, 3, 4, 6, 7]))
    assert part is not None
    assert part.stretch.tolist() == [0, 0, 1, 1, 2, 2]
    assert part.lengths == (2, 2, 2)


def test_averaged_rows_are_further_apart() -> None:
    found = motion().averaged(np.repeat(np.arange(6), 2))
    assert found.knee_rad == pytest.approx(1.0)
    assert found.noise_rad == pytest.approx(1e-3 / np.sqrt(2.0))
    assert found.lengths == (3, 3)


def test_joined_with_one_that_has_a_reference_the_shaft_is_free_in_its_own_rows_alone() -> None:
    joined = EstimatedMotion.joined([None, motion()], [4, 12])
    assert joined is not None
    assert joined.lengths == (4, 6, 6)
    assert np.all(joined.spectrum[:4] == 0.0)
    assert np.all(joined.spectrum[4:] > 0.0)
    assert joined.part(np.arange(4)) is None
    assert EstimatedMotion.joined([None, None], [4, 4]) is None


def test_at_the_knee_the_motion_is_as_free_as_a_reading_is_noisy() -> None:
    rows = 1000
    found = EstimatedMotion(stretch=np.zeros(rows, dtype=np.int64), knee_rad=np.full(rows, 0.1 * np.pi), noise_rad=1e-3)
    assert found.spectrum[100] == pytest.approx(1.0)
    assert found.spectrum[200] == pytest.approx(2.0**-6)
    assert np.all(np.diff(found.spectrum[1:]) <= 0.0)
