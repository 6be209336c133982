"""Recording levels: what tells how loud each recording of a device is."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.discovery.marks.outliers import bounded_rms
from twin.angles import Array

STEP_DEG = 360.0 / 2.0**14


def rounded(turns_per_s: float, *, seed: int) -> dict[str, Any]:
    """A shaft at one speed, a sensor with an error of order 1, its noise three tenths of its word's step."""
    time = np.arange(1500) / 1000.0
    angle = 360.0 * turns_per_s * time
    read = angle + 0.3 * np.cos(np.radians(angle)) + 0.3 * STEP_DEG * np.random.default_rng(seed).standard_normal(1500)
    return {"time_s": time, "measured_deg": np.mod(STEP_DEG * np.round(read / STEP_DEG), 360.0)}


def second_differences(away: float, *, seed: int = 0) -> Array:
    """Of rounded noise of three tenths of a step, readings being so many steps apart."""
    even = away * np.arange(20_000)
    read = np.round(even + 0.3 * np.random.default_rng(seed).standard_normal(even.size))
    return np.diff(read - even, 2)


def test_noise_near_a_step_of_the_word_makes_no_recording_louder() -> None:
    """Nor is it louder at the higher speed, as uncertain instants would make it."""
    found = explain([rounded(9.415, seed=1), rounded(27.369, seed=2)])
    assert "time_jitter" not in [cause.name for cause in found.causes]


@pytest.mark.parametrize("away", [154.256, 448.424, 7.37])
def test_the_size_of_values_with_steps(away: float) -> None:
    values = second_differences(away)
    assert bounded_rms(values) == pytest.approx(float(np.sqrt(np.mean(values**2))), rel=0.03)


def test_a_tenth_of_the_values_far_off_changes_little() -> None:
    rng = np.random.default_rng(0)
    values = rng.standard_normal(10_000)
    assert bounded_rms(values) == pytest.approx(1.0, rel=0.02)
    values[rng.random(values.size) < 0.1] = 1e3
    assert bounded_rms(values) < 1.25
    assert bounded_rms(np.zeros(5)) == 0.0
