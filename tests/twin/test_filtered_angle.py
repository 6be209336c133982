"""latency: the moments of a filter's response, against the filter itself run in time."""

from __future__ import annotations

import numpy as np
import pytest

from scenarios.bench.hall_node import check_playable
from twin import Chain, Motion
from twin.angles import wrap
from twin.errors import UserError

NATURAL_RAD_S, DAMPING = 2000.0, 0.8


def _loop(step_s: float) -> np.ndarray:
    """Pulse response (taps,) of a tracking loop of type 2, (2 d w s + w^2) / (s^2 + 2 d w s + w^2), in fine steps."""
    time = (np.arange(8000) + 0.5) * step_s
    ringing = NATURAL_RAD_S * np.sqrt(1.0 - DAMPING**2)
    decay = np.exp(-DAMPING * NATURAL_RAD_S * time)
    sine = (1.0 - 2.0 * DAMPING**2) * NATURAL_RAD_S**2 / ringing * np.sin(ringing * time)
    taps = decay * (2.0 * DAMPING * NATURAL_RAD_S * np.cos(ringing * time) + sine)
    return taps / taps.sum()


@pytest.mark.parametrize("sense", [1, -1])
def test_is_what_the_filter_does_run_in_time(sense: int) -> None:
    speed, step_s = 100.0, 2e-6
    taps = _loop(step_s)
    time = step_s * np.arange(taps.size)
    mean = taps @ time
    variance, third = taps @ (time - mean) ** 2, taps @ (time - mean) ** 3
    chain = Chain(sensor_sense=sense).with_effect("offset", x_percent=3.0).with_effect("gain_mismatch", ratio=1.05)
    fine = np.arange(-taps.size * step_s, 2.0 * np.pi / speed, step_s)
    angle = np.unwrap(chain.readings(Motion.from_angle(speed * fine)))
    followed = np.convolve(angle, taps, mode="valid")[1:]
    shown = slice(taps.size, None, 200)
    at = fine[shown]
    motion = Motion.from_angle(speed * at, time_s=at, speed_rad_s=np.full(at.size, speed))
    moments = {"variance_ms2": 1e6 * variance, "third_moment_ms3": 1e9 * third}
    told = chain.with_effect("latency", delay_us=1e6 * mean, **moments).readings(motion)
    off = wrap(told - followed[::200][: told.size])
    # the fourth cumulant is left: order 2 turns by (2 w / natural)^4 of its 2.8 deg, 1e-4
    left = np.degrees(np.max(np.abs(off - np.mean(off))))
    plain = chain.with_effect("latency", delay_us=1e6 * mean).readings(motion)
    unfiltered = np.degrees(np.max(np.abs(wrap(plain - followed[::200][: told.size]))))
    assert left < 1e-3
    assert unfiltered > 10.0 * left


def test_a_node_on_the_bus_does_not_know_a_whole_turn() -> None:
    check_playable(Chain().with_effect("latency", delay_us=20.0))
    with pytest.raises(UserError, match="latency"):
        check_playable(Chain().with_effect("latency", delay_us=20.0, variance_ms2=0.1))


def test_the_variance_acts_on_the_acceleration() -> None:
    time = np.linspace(0.0, 1.0, 500)
    speed = 20.0 + 30.0 * np.sin(9.0 * time)
    shaft = 20.0 * time + 30.0 / 9.0 * (1.0 - np.cos(9.0 * time))
    motion = Motion.from_angle(shaft, time_s=time, speed_rad_s=speed)
    found = wrap(Chain().with_effect("latency", variance_ms2=4.0).readings(motion) - shaft)
    # differences over two steps of 2 ms err by (9 x 0.002)^2 / 6 of it
    np.testing.assert_allclose(found[2:-2], 0.5 * 4e-6 * 270.0 * np.cos(9.0 * time[2:-2]), atol=1e-3 * 5.4e-4)
