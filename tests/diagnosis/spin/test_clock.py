"""Coarse time stamps hide an even clock, which a straight line over the readings' number shows."""

from __future__ import annotations

import numpy as np

from diagnosis.spin.clock import even_clock


def test_frames_of_a_millisecond_hide_a_clock_of_a_quarter() -> None:
    true = 0.00031 + 0.00037 * np.arange(2000)
    found = even_clock(np.ceil(true / 0.001) * 0.001)
    assert found is not None
    assert np.ptp(found - true) < 2e-5


def test_fine_stamps_are_taken_as_they_are() -> None:
    rng = np.random.default_rng(1)
    assert even_clock(np.cumsum(0.001 + 2e-5 * rng.standard_normal(2000))) is None


def test_readings_that_are_known_to_be_missing_make_no_other_clock() -> None:
    """Every 50th cell is empty: by their own numbers the readings are as even as their stamps."""
    number = np.delete(np.arange(2000), np.arange(0, 2000, 50))
    assert even_clock(0.001 * number, number) is None


def test_where_readings_are_lost_no_even_clock_explains_the_stamps() -> None:
    true = np.delete(0.00037 * np.arange(2000), slice(700, 760))
    assert even_clock(np.ceil(true / 0.001) * 0.001) is None
