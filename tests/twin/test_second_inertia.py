"""A torque turns a shaft with a second inertia behind a spring as both equations of motion say."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from twin.angles import TAU, Array
from twin.mechanics.torque_ripple import response
from twin.second_inertia import Behind, SecondInertia

SECOND = SecondInertia(resonance_rad_s=TAU * 12.0, damping=0.02, share=0.4)
ORDER, SIZE = 3, 0.5


def swung(times: Array, *, speed: float, slows: float) -> Array:
    """What a torque that gives both inertias together 0.5 rad/s^2 turns the rotor by, integrated (n,) [rad]."""
    held = SECOND.resonance_rad_s / np.sqrt(1.0 + SECOND.share)
    stiff, damps = held**2, 2.0 * SECOND.damping * held

    def moved(time: float, state: Array) -> list[float]:
        away, rate, far, far_rate = state
        pull = stiff * (away - far) + damps * (rate - far_rate)
        torque = SIZE * (1.0 + SECOND.share) * np.cos(ORDER * (speed * time + 0.5 * slows * time**2))
        return [rate, torque - SECOND.share * pull, far_rate, pull]

    return np.asarray(solve_ivp(moved, times[[0, -1]], [0.0] * 4, t_eval=times, rtol=1e-9, atol=1e-13).y[0])


@pytest.mark.parametrize("stretches", [(slice(0, 4000),), (slice(0, 1000), slice(1000, 4000))])
def test_a_coast_passes_the_resonance_as_the_equations_of_motion_say(stretches: tuple[slice, ...]) -> None:
    """Readings 13 degrees of the torque's phase apart; it passes the resonance so fast that its swing rings on."""
    times, speed, slows = np.linspace(0.0, 8.0, 4000), 36.0, -3.0
    found = swung(times, speed=speed, slows=slows)
    even = {
        "shaft_rad": speed * times + 0.5 * slows * times**2,
        "speed_rad_s": speed + slows * times,
        "acceleration_rad_s2": np.full(times.size, slows),
    }
    (told, _) = SIZE * response(ORDER, **even, behind=Behind(SECOND, times, stretches))
    (of_one_piece, _) = SIZE * response(ORDER, **even)
    # How the motion begins gives it a straight line and a swing, which has died away where the resonance is passed.
    later = times > 3.0
    begins = np.stack([np.ones_like(times), times])

    def left(columns: Array) -> float:
        every = np.vstack([begins, columns])[:, later]
        part = np.linalg.lstsq(every.T, found[later], rcond=None)[0]
        return float(np.std(found[later] - part @ every))

    assert np.std(told[later]) == pytest.approx(left(np.zeros((0, times.size))), rel=0.01)
    assert left(told[None]) < 0.01 * np.std(told[later])
    assert left(of_one_piece[None]) > 0.5 * np.std(told[later])


@pytest.mark.parametrize("frequency_Hz", [0.5, 10.0, 12.0, 60.0])
def test_at_one_speed_it_is_the_response_at_that_frequency(frequency_Hz: float) -> None:
    at, held = 1j * TAU * frequency_Hz, SECOND.resonance_rad_s / np.sqrt(1.0 + SECOND.share)
    above = 1.0 + 2.0 * SECOND.damping * at / held + (at / held) ** 2
    expected = above / (1.0 + 2.0 * SECOND.damping * at / held + (at / SECOND.resonance_rad_s) ** 2)
    times = np.linspace(0.0, 0.1, 50)
    angle, speed = TAU * frequency_Hz * times, np.full(times.size, TAU * frequency_Hz)
    behind = Behind(SECOND, times, (slice(0, times.size),))
    told = behind.carried(np.ones(times.size, dtype=np.complex128), 1.0, shaft_rad=angle, speed_rad_s=speed)
    assert told * np.exp(-1j * angle) == pytest.approx(expected, rel=1e-9)


def test_a_swing_that_has_long_died_away_is_worked_out_without_overflow() -> None:
    times = np.arange(2000) * 1.0
    behind = Behind(SECOND, times, (slice(0, 2000),))
    told = behind.carried(
        np.ones(2000, dtype=np.complex128), 1.0, shaft_rad=0.1 * times, speed_rad_s=np.full(2000, 0.1)
    )
    assert np.all(np.isfinite(told))
    assert told[1000:] * np.exp(-0.1j * times[1000:]) == pytest.approx(1.0, rel=1e-4)


def test_of_one_step_longer_than_any_swing_the_next_is_steady() -> None:
    """A gap in which the swing dies by more than the numbers' range holds."""
    times = np.concatenate([np.arange(50) * 0.01, 1000.0 + np.arange(50) * 0.01])
    even = {"shaft_rad": 0.1 * times, "speed_rad_s": np.full(100, 0.1)}
    behind = Behind(SECOND, times, (slice(0, 100),))
    told = behind.carried(np.ones(100, dtype=np.complex128), 1.0, **even)
    assert told * np.exp(-0.1j * times) == pytest.approx(1.0, rel=1e-4)
