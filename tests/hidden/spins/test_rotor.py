"""Rotors obey mechanics: energy, the response to a torque, what acts in time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from .benches import TURN, coast
from .drives import Speeds
from .rotor import Belt, Hum, Rotor, Step, Trajectory, Wave, integrate

Array = np.ndarray[Any, np.dtype[np.float64]]


def energy_of(rotor: Rotor, path: Trajectory) -> Array:
    """Energies [rad^2/s^2], a unit of the rotor's inertia, all but what friction takes."""
    energy = 0.5 * path.speed**2
    for wave in rotor.waves:
        energy = energy + wave.size / wave.order * np.cos(wave.order * path.angle + wave.phase)
    if rotor.belt is not None:
        stiffness = rotor.belt.inertia * (TURN * rotor.belt.frequency_Hz) ** 2
        twist = path.angle - path.behind_angle
        energy = energy + 0.5 * rotor.belt.inertia * path.behind_speed**2 + 0.5 * stiffness * twist**2
    return np.asarray(energy)


def test_without_friction_the_energy_stays() -> None:
    waves = (Wave(1, 30.0, 0.3), Wave(6, 400.0, 1.0))
    rotor = Rotor(waves=waves, belt=Belt(30.0, 0.0, 0.3))
    path = integrate(rotor, None, speed=60.0, duration_s=2.0)
    energy = energy_of(rotor, path)
    exchanged = np.ptp(0.5 * path.speed**2)
    assert exchanged > 100.0
    assert np.ptp(energy) < 1e-3 * exchanged


def test_friction_takes_the_energy_that_is_lost() -> None:
    rotor = Rotor(
        coulomb=10.0,
        viscous=0.4,
        quadratic=0.002,
        drag_ripple=0.1,
        viscous_ripple=0.05,
        drag_phase=0.7,
        waves=(Wave(4, 200.0, 0.2),),
    )
    path = integrate(rotor, None, speed=100.0, duration_s=4.0, stop=20.0)
    power = [
        (rotor.friction(speed) + (1.0 + 0.02 * speed) * math.cos(angle + 0.7)) * speed
        for angle, speed in zip(path.angle.tolist(), path.speed.tolist(), strict=True)
    ]
    energy = energy_of(rotor, path)
    assert np.sum(0.5 * np.add(power[1:], power[:-1]) * np.diff(path.time_s)) == pytest.approx(
        energy[0] - energy[-1], rel=1e-3
    )
    assert path.speed[-1] == pytest.approx(20.0, rel=0.05)


def response(rotor: Rotor, order: int, speed: float, drive: Speeds | None = None) -> float:
    """Amplitude [deg] of an order in the angle at a nearly constant speed, about a cubic in time."""
    path = integrate(rotor, drive, speed=speed, duration_s=20.0 * TURN / speed)
    times = np.linspace(0.2, 0.9, 4000) * path.time_s[-1]
    angle = path.at(times)[0]
    share = np.linspace(-1.0, 1.0, times.size)
    waves = [np.cos(order * angle), np.sin(order * angle)]
    found = np.linalg.lstsq(np.column_stack([np.vander(share, 4), *waves]), angle, rcond=None)[0]
    return math.degrees(math.hypot(*found[-2:]))


@pytest.mark.parametrize("order", [1, 3, 12])
def test_response_to_a_torque_falls_as_speed_squared(order: int) -> None:
    rotor = Rotor(waves=(Wave(order, 20.0 * order, 0.4),))
    slow, fast = response(rotor, order, 60.0), response(rotor, order, 120.0)
    assert slow == pytest.approx(rotor.response_deg(order, 60.0), rel=0.03)
    assert slow / fast == pytest.approx(4.0, rel=0.03)


@pytest.mark.parametrize("dry", [True, False])
def test_drag_that_comes_and_goes_once_a_turn_is_an_order_1(dry: bool) -> None:
    """Of the dry friction its response falls as the speed squared, of the viscous one as the speed."""
    friction = {"coulomb": 24.0, "drag_ripple": 0.1} if dry else {"viscous": 0.4, "viscous_ripple": 0.1}
    rotor = Rotor(**friction, drag_phase=2.0)
    found = []
    for speed in (60.0, 120.0):
        drive = Speeds((0.0,), (speed,), gain=0.0, feed=rotor.friction(speed))
        found.append(response(rotor, 1, speed, drive))
        assert found[-1] == pytest.approx(rotor.response_deg(1, speed), rel=0.05)
    assert found[0] / found[1] == pytest.approx(4.0 if dry else 2.0, rel=0.05)


def test_a_torque_adds_to_the_drag() -> None:
    rotor = Rotor(coulomb=20.0, drag_ripple=0.1, drag_phase=2.0, waves=(Wave(1, 1.0, 1.0),))
    drive = Speeds((0.0,), (60.0,), gain=0.0, feed=20.0)
    assert response(rotor, 1, 60.0, drive) == pytest.approx(rotor.response_deg(1, 60.0), rel=0.05)


def test_between_the_steps_lies_the_cubic() -> None:
    """Which a motion of constant jerk is."""
    steps, between = np.array([0.0, 0.1, 0.35, 0.5]), np.array([0.0, 0.04, 0.2, 0.34, 0.5])

    def angle(time: Array) -> Array:
        return np.asarray(1.0 + 2.0 * time - 3.0 * time**2 + 4.0 * time**3)

    def speed(time: Array) -> Array:
        return np.asarray(2.0 - 6.0 * time + 12.0 * time**2)

    path = Trajectory(steps, angle(steps), speed(steps), steps, steps)
    np.testing.assert_allclose(path.at(between), [angle(between), speed(between)], rtol=1e-12)


def test_mains_and_load_act_in_time() -> None:
    hum = Hum(100.0, 50.0, 0.0)
    path = integrate(Rotor(hums=(hum,)), None, speed=50.0, duration_s=1.0)
    times = np.linspace(0.1, 0.9, 8000)
    waves = [np.cos(TURN * 100.0 * times), np.sin(TURN * 100.0 * times)]
    found = np.linalg.lstsq(np.column_stack([np.vander(times, 2), *waves]), path.at(times)[0], rcond=None)[0]
    assert math.hypot(*found[-2:]) == pytest.approx(50.0 / (TURN * 100.0) ** 2, rel=0.01)
    loaded = integrate(Rotor(steps=(Step(0.5, -8.0),)), None, speed=50.0, duration_s=1.0)
    assert loaded.at(np.array([0.49, 0.99]))[1] == pytest.approx([50.0, 50.0 - 8.0 * 0.49], rel=5e-3)


def test_a_belt_swings_at_its_resonance() -> None:
    """Against the rotor's own inertia the spring is stiffer by the share of the second one."""
    belt = Belt(20.0, 0.0, 0.5)
    path = integrate(Rotor(belt=belt, steps=(Step(0.0, 5.0),)), None, speed=0.0, duration_s=2.0)
    times = np.linspace(0.0, 2.0, 16384, endpoint=False)
    twist = path.at(times)[0] - np.interp(times, path.time_s, path.behind_angle)
    spectrum = np.abs(np.fft.rfft((twist - twist.mean()) * np.hanning(times.size)))
    assert int(spectrum.argmax()) / 2.0 == pytest.approx(20.0 * math.sqrt(1.5), abs=0.3)


def test_a_coast_slows_to_where_it_is_meant_to() -> None:
    """Its friction is drawn for a time; torques must neither stop it early nor keep it going."""
    for seed in range(6):
        (spin,) = coast(np.random.default_rng(seed))
        path = spin.run()
        assert path.speed[-1] < spin.stop
        assert path.time_s[-1] == pytest.approx(spin.expected_s, rel=0.6)
