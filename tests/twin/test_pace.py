"""The speed of the shaft by the reference's angles over their time stamps."""

from __future__ import annotations

import numpy as np
import pytest

from twin.angles import TAU, Array
from twin.motion import Motion
from twin.pace import speed_over_time

RATE_HZ, SECONDS = 2000.0, 4.0
TIME = np.arange(int(RATE_HZ * SECONDS)) / RATE_HZ
FIRST, FALL_S = 300.0, 2.0
SPEED = FIRST * np.exp(-TIME / FALL_S)
"""Of a shaft that coasts down under friction that grows with the speed [rad/s]."""
ANGLE = FIRST * FALL_S * (1.0 - np.exp(-TIME / FALL_S))


def off(speed: Array, true: Array = SPEED) -> float:
    """RMS of the speed's error as a share of it."""
    return float(np.sqrt(np.mean((speed / true - 1.0) ** 2)))


def of(time_s: Array, angle: Array = ANGLE) -> Array:
    return speed_over_time(angle, time_s, np.ones(angle.size))


def test_a_coast_has_no_one_speed() -> None:
    # A parabola over 17 readings of an exponential: (8.5 ms / 2 s)^2 / 6.
    assert off(of(TIME)) < 1e-5


def test_counts_of_the_reference_do_not_show_in_the_speed() -> None:
    step = TAU / 4096.0
    # A step's RMS of 0.00044 rad over 8.5 ms is 17 % of the slowest speed: only wider windows tell it.
    assert off(of(TIME, np.round(ANGLE / step) * step)) < 1e-3


@pytest.mark.parametrize("tick_s", [0.00137, 0.0071])
def test_stamps_of_a_coarse_clock_tell_the_speed(tick_s: float) -> None:
    # All readings of a stamp have one speed, which changes by up to tick / 2 s, 0.36 %, from stamp to stamp.
    assert off(of(np.floor(TIME / tick_s) * tick_s)) < 1e-2


def test_stamps_farther_apart_than_a_stop_are_those_of_a_moving_shaft_that_moves_between_them() -> None:
    # 25 ms of 2 s on either side.
    assert off(of(np.floor(TIME / 0.05) * 0.05)) < 0.025


def test_a_first_stamp_of_few_readings_is_no_speed_of_its_own() -> None:
    found = of(np.floor((TIME + 0.0057) / 0.0071) * 0.0071)
    assert float(np.max(np.abs(found / SPEED - 1.0))) < 0.05


def test_coarse_stamps_leave_an_even_speed_unbiased() -> None:
    # One or two readings a stamp, at 5/9 ms: the median step is twice 5/9 of a millisecond's.
    time = np.arange(2000) / 1800.0
    found = of(np.floor(time * 1e3) / 1e3, 30.0 * time)
    assert found == pytest.approx(30.0, rel=2e-3)


def test_stamps_that_jitter_tell_the_speed() -> None:
    late = np.random.default_rng(1).uniform(0.0, 0.8 / RATE_HZ, TIME.size)
    # Each step's own pace is off by half of it.
    assert off(of(TIME + late)) < 5e-3


def test_a_pause_between_readings_is_no_slow_shaft() -> None:
    assert off(of(np.where(TIME < 1.7, TIME, TIME + 20.0))) < 1e-4


def test_a_clock_that_is_set_back_goes_on() -> None:
    assert off(of(np.where(TIME < 1.7, TIME, TIME - 1.0))) < 1e-4


def test_lost_readings_leave_the_speed() -> None:
    kept = np.sort(np.random.default_rng(2).choice(TIME.size, TIME.size // 2, replace=False))
    assert off(of(TIME[kept], ANGLE[kept]), SPEED[kept]) < 1e-4


@pytest.mark.parametrize("tick_s", [0.0, 1e-3])
def test_steady_speeds_stay_what_they_are(tick_s: float) -> None:
    """Three speeds there and back, the angles even: nothing is blurred where one goes over to the next."""
    speeds = np.array([10.0, 60.0, 200.0, -10.0, -60.0, -200.0])
    rows, step = 720, TAU / 360.0
    way = np.repeat(np.sign(speeds), rows)
    time = np.cumsum(step / np.abs(np.repeat(speeds, rows)))
    stamps = time if tick_s == 0.0 else np.floor(time / tick_s) * tick_s
    found = speed_over_time(np.cumsum(step * way), stamps, way)
    away = np.abs(found / np.repeat(speeds, rows) - 1.0) > 0.02
    # Beside each change the rows of one stamp belong to either speed: of 1 ms, up to 12.
    assert np.count_nonzero(away) <= (6 if tick_s == 0.0 else 6 * 12)


def test_where_the_pace_changes_a_reading_has_the_one_by_which_it_was_reached() -> None:
    """One that is late reads where that led from: by the new pace it would be off by the delay times the change."""
    reached = np.repeat([10.0, 50.0, 20.0], 400)
    found = of(np.arange(1201) * 2e-3, np.concatenate([[0.0], np.cumsum(2e-3 * reached)]))
    np.testing.assert_allclose(found, np.concatenate([reached[:1], reached]), rtol=1e-9)


def test_one_even_speed_is_one_speed() -> None:
    time = TIME + np.random.default_rng(3).normal(0.0, 0.05 / RATE_HZ, TIME.size)
    found = of(time, 20.0 * TIME)
    assert np.ptp(found) == 0.0
    assert found[0] == pytest.approx(20.0, rel=1e-3)


def test_readings_far_apart_are_taken_at_standstill() -> None:
    angle, time = np.arange(0.0, 20.0, 0.05), np.arange(400) * 0.1
    assert not np.any(speed_over_time(angle, time, np.ones(400)))
    # Ten at each stop under one stamp lie 0.01 s apart on average, and the shaft stands all the same.
    assert not np.any(speed_over_time(np.repeat(angle, 10), np.repeat(time, 10), np.ones(4000)))


def test_a_coast_provides_two_speeds_and_one_that_varies() -> None:
    assert {"two speeds", "varying speed"} <= Motion.from_angle(ANGLE, time_s=TIME).provides
    steady = Motion.from_angle(20.0 * TIME, time_s=TIME).provides
    assert "moving shaft" in steady
    assert not {"two speeds", "varying speed"} & steady
