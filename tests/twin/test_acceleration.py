"""Acceleration of the shaft, and the twist that its torque makes."""

from __future__ import annotations

import numpy as np
import pytest

from twin import Chain, Motion


def motion(time_s: np.ndarray, speed_rad_s: np.ndarray) -> Motion:
    shaft = np.concatenate([[0.0], np.cumsum(0.5 * (speed_rad_s[1:] + speed_rad_s[:-1]) * np.diff(time_s))])
    return Motion.from_angle(shaft, time_s=time_s, speed_rad_s=speed_rad_s, direction=np.sign(speed_rad_s))


def test_acceleration_of_a_parabola_is_exact_between_uneven_readings() -> None:
    time = np.cumsum(np.random.default_rng(1).uniform(0.001, 0.01, 200))
    found = motion(time, 3.0 + 2.0 * time + 5.0 * time**2).acceleration_rad_s2
    assert np.allclose(found[1:-1], (2.0 + 10.0 * time)[1:-1])


def test_steady_speeds_with_steps_between_them_are_no_varying_speed() -> None:
    time = np.arange(300) * 0.002
    steps = motion(time, np.repeat([20.0, 60.0, -20.0], 100))
    swing = motion(time, 60.0 * np.cos(2 * np.pi * time / 0.6))
    assert "varying speed" not in steps.provides
    assert "varying speed" in swing.provides


def test_the_magnet_stays_behind_by_the_twist() -> None:
    time = np.arange(300) * 0.002
    ramp = motion(time, 10.0 + 1000.0 * np.pi / 30.0 * time)
    chain = Chain().with_effect("load_torsion", deg_per_krpm_per_s=0.3)
    # an acceleration of 1000 rpm a second
    assert np.degrees(chain.error(ramp)) == pytest.approx(np.full(300, -0.3), abs=1e-9)
