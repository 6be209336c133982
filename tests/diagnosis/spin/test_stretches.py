"""Readings are counted on over whole turns; standstill, gaps and readings far off count no turn."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.spin.stretches import counted_on, turning

TIME = np.arange(0.0, 4.0, 0.001)


def wrapped(angle: np.ndarray) -> np.ndarray:
    return np.asarray(np.mod(angle, 2.0 * np.pi))


def test_a_reading_far_off_counts_no_turn() -> None:
    angle = 60.0 * TIME
    for row, off in ((500, 2.9), (1500, -2.9), (2500, 3.1)):
        read = wrapped(angle)
        read[row] += off
        counted = counted_on(read, TIME)
        assert counted[-1] - counted[0] == pytest.approx(angle[-1] - angle[0], abs=1e-6)


def test_standing_still_is_left_out() -> None:
    angle = 60.0 * np.clip(TIME, 1.0, 3.0)
    found = turning(wrapped(angle + 1e-3 * np.random.default_rng(1).standard_normal(TIME.size)), TIME)
    assert 0.9 < TIME[found.rows[0]] < 1.3
    assert 2.7 < TIME[found.rows[-1]] < 3.1
    assert set(found.stretch) == {0}


def test_after_a_gap_a_stretch_begins_anew() -> None:
    keep = (TIME < 1.5) | (TIME > 2.5)
    found = turning(wrapped(60.0 * TIME[keep]), TIME[keep])
    assert found.stretch.max() == 1
    assert found.rows.size == keep.sum()


def test_a_second_reading_of_one_instant_is_no_motion() -> None:
    time = np.sort(np.concatenate([TIME, TIME[100:110]]))
    found = turning(wrapped(60.0 * time), time)
    assert found.rows.size == TIME.size
