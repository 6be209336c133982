"""The temperature of the sensor's body behind the recorded one, and a quantity that bends with it."""

from __future__ import annotations

import numpy as np
import pytest

from scenarios.commands.protocol import Protocol
from twin.angles import Array
from twin.chain import Chain
from twin.hall.body_temperature import warmth
from twin.motion import Motion

TIME_S = np.arange(0.0, 60.0, 2.0)


def motion(temperature_c: Array) -> Motion:
    return Motion.from_angle(np.radians(3.0 * TIME_S), time_s=TIME_S, temperature_c=temperature_c)


@pytest.mark.parametrize("temperature_c", [25.0, 85.0])
def test_at_one_temperature_the_body_is_not_behind(temperature_c: float) -> None:
    still = motion(np.full(TIME_S.size, temperature_c))
    np.testing.assert_array_equal(warmth(still, np.array(20.0), np.array(0.0)), temperature_c - 25.0)
    assert warmth(still, np.array([[20.0]]), np.array([[0.0]])).shape == (1, TIME_S.size)


def test_after_a_step_the_body_follows_by_its_time_constant() -> None:
    stepped = motion(np.where(TIME_S < 20.0, 25.0, 85.0))
    # The step is taken to have come right after the last reading before it.
    follows = np.where(TIME_S < 20.0, 0.0, -60.0 * np.expm1(-(TIME_S - 18.0) / 20.0))
    np.testing.assert_allclose(warmth(stepped, np.array(20.0), np.array(0.0)), follows, atol=1e-12)


def test_the_slope_at_25_c_is_1() -> None:
    warm = motion(np.where(TIME_S < 20.0, 25.0 - 1e-4, 25.0 + 1e-4))
    np.testing.assert_allclose(np.ptp(warmth(warm, np.array(0.0), np.array(0.02))), 2e-4, rtol=1e-9)


def test_a_lagging_twin_is_simulated_at_one_temperature() -> None:
    """It reads as one that does not lag."""
    drift = {"x_percent_per_K": 0.01, "y_percent_per_K": 0.006}
    plain, lagging = (Chain().with_effect("offset_drift", **drift, lag_s=lag_s) for lag_s in (0.0, 20.0))
    turn = Protocol(turns=1, points=36, speeds_rpm=(60.0,), temperatures_c=(85.0,)).motion()
    assert "time_s" in turn.provides
    expected, found = (chain.simulate(turn, seed=1).measured_deg for chain in (plain, lagging))
    np.testing.assert_array_equal(found, expected)
