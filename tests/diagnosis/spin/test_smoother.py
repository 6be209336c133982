"""Of a spin with a known truth the sensor's error is found, torques are told from it, and what is not told is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.coefficients import observables_to_cosine
from diagnosis.discovery.fitting.nuisance import without_nuisance
from diagnosis.discovery.fitting.observations import collect
from diagnosis.spin.columns import HIGHEST_ORDER
from diagnosis.spin.of_log import sweeps_of
from diagnosis.spin.smoother import MotionFit, fitted_motion
from diagnosis.spin.torques import Loose, torque_columns
from tests.hidden.spins.generator import draw
from twin.noise.spectrum import to_cosine, to_rows
from twin.spin import Spin

TIME = np.arange(0.0, 6.0, 0.001)
OFFSET = 0.01
"""Amplitude [rad] of the sensor's order 1."""
NOISE = 3e-4
COGGING = 60.0
"""Acceleration [rad/s^2] of order 3."""


def coasting(*, cogging: float = COGGING, last: float = 30.0, order: int = 3) -> np.ndarray:
    """A shaft that slows from 120 rad/s to ``last``, its angle (n,) [rad] by fine steps of the equation of motion."""
    slows, steps = (last - 120.0) / TIME[-1], 10
    angle, speed, out = 0.0, 120.0, np.empty(TIME.size)
    step = 0.001 / steps
    for row in range(TIME.size):
        out[row] = angle
        for _ in range(steps):
            half = speed + 0.5 * step * (slows + cogging * np.cos(order * angle))
            angle += step * half
            speed = half + 0.5 * step * (slows + cogging * np.cos(order * angle))
    return out


def read(angle: np.ndarray, *, seed: int = 1) -> np.ndarray:
    noise = NOISE * np.random.default_rng(seed).standard_normal(angle.size)
    return np.asarray(angle + OFFSET * np.sin(angle) + 0.004 * np.cos(3.0 * angle) + noise)


def fitted(angle: np.ndarray) -> MotionFit:
    return fitted_motion(read(angle), TIME, [slice(0, TIME.size)])


def error_of(fit: MotionFit, order: int) -> np.ndarray:
    return np.asarray(fit.terms.values[2 * order - 2 : 2 * order])


def test_a_coast_tells_the_sensor_from_a_torque_of_the_same_order() -> None:
    """Both of order 3: 0.004 rad of the sensor, and a torque that turns the shaft by 0.0005 to 0.007 rad."""
    fit = fitted(coasting())
    sd = np.sqrt(np.diag(fit.terms.covariance))
    assert error_of(fit, 1) == pytest.approx([0.0, OFFSET], abs=5.0 * sd[0])
    assert error_of(fit, 3) == pytest.approx([0.004, 0.0], abs=5.0 * sd[4])
    assert sd[4] < 3e-4
    torque = fit.terms.values[2 * HIGHEST_ORDER + 4 : 2 * HIGHEST_ORDER + 6]
    assert np.hypot(*torque) == pytest.approx(COGGING, rel=0.1)
    assert fit.separable[:4].all()
    assert fit.noise_rad[0] == pytest.approx(NOISE, rel=0.1)


def test_at_one_speed_a_torque_is_taken_for_the_sensors() -> None:
    fit = fitted(coasting(last=105.0))
    assert not fit.separable.any()
    assert np.hypot(*(error_of(fit, 3) - [0.004, 0.0])) > 5e-4


def test_a_torque_that_speeds_the_shaft_up_and_slows_it_down_makes_no_second_speed() -> None:
    """Order 3: the shaft goes at 14 to 26 rad/s in each third of a turn, and at 19 to 21 on the whole."""
    turned = 20.0 * TIME + 0.8 * np.sin(1.5 * TIME)
    angle = turned + 0.1 * np.sin(3.0 * turned)
    assert np.ptp(np.quantile(np.diff(read(angle)) / 0.001, [0.1, 0.9])) > 8.0
    assert not fitted(angle).separable.any()


def test_no_torque_is_seen_where_none_is() -> None:
    fit = fitted(coasting(cogging=0.0))
    assert np.hypot(*fit.terms.values[2 * HIGHEST_ORDER + 4 : 2 * HIGHEST_ORDER + 6]) < 0.1 * COGGING


def test_a_torque_of_a_high_order_is_one() -> None:
    fit = fitted(coasting(cogging=2000.0, order=24))
    place = 2 * HIGHEST_ORDER + 2 * 23
    assert np.hypot(*fit.terms.values[place : place + 2]) == pytest.approx(2000.0, rel=0.1)
    assert np.hypot(*error_of(fit, 24)) < 1e-4


def test_a_wave_in_time_is_no_motion() -> None:
    """The mains in a channel, ten times the noise: a motion that held it would hold all that is slower too."""
    angle = coasting()
    hum = 10.0 * NOISE * np.cos(2.0 * np.pi * 50.0 * TIME) * np.cos(angle)
    fit = fitted_motion(read(angle) + hum, TIME, [slice(0, TIME.size)])
    assert np.median(fit.knee_rad_s) < 60.0
    assert error_of(fit, 1) == pytest.approx([0.0, OFFSET], abs=3e-4)


def test_an_error_that_grows_with_the_speed_is_no_torque() -> None:
    """Of order 2, as of a channel that is read late: 5 us here."""
    angle = coasting()
    late = 5e-6 * np.gradient(angle, TIME) * np.cos(2.0 * angle)
    fit = fitted_motion(read(angle) + late, TIME, [slice(0, TIME.size)])
    assert fit.terms.values[-3:-1] == pytest.approx([5e-6, 0.0], abs=5e-7)
    assert error_of(fit, 2) == pytest.approx([0.0, 0.0], abs=5e-5)


def test_a_torque_at_two_speeds_is_no_channel_read_late() -> None:
    """Both are of order 2, and what differs between them from one speed to the other is the sensor's error."""
    time = np.arange(0.0, 3.0, 0.001)
    logs = []
    for seed, (speed, settles) in enumerate(((94.0, 0.0), (306.0, 0.03))):
        angle = speed * (time - 0.4 * settles * (1.0 - np.exp(-time / 0.4)))
        torque = 0.002 * (94.0 / np.gradient(angle, time)) ** 2 * np.cos(2.0 * angle + 1.0)
        noise = NOISE * np.random.default_rng(seed + 1).standard_normal(time.size)
        logs.append(angle + torque + OFFSET * np.sin(2.0 * angle) + noise)
    slices = [slice(0, time.size), slice(time.size, 2 * time.size)]
    fit = fitted_motion(np.concatenate(logs), np.concatenate([time, time + 4.0]), slices)
    assert error_of(fit, 2) == pytest.approx([0.0, OFFSET], abs=4e-4)


def test_dry_friction_reverses_with_the_direction() -> None:
    """Its torque of order 1 does so too: there and back it is told from one that does not."""
    there, rubbing = coasting(cogging=0.0), 20.0
    speed = np.gradient(there, TIME)
    turned = -rubbing * np.cos(there) / speed**2
    both = np.concatenate([there + turned, -there + rubbing * np.cos(there) / speed**2])
    time = np.concatenate([TIME, TIME[-1] + 1.0 + TIME])
    readings = np.concatenate([read(both[: TIME.size]), read(both[TIME.size :], seed=2)])
    slices = [slice(0, TIME.size), slice(TIME.size, 2 * TIME.size)]
    fit = fitted_motion(readings, time, slices)
    # To first order so strong a rub leaves a ten-thousandth; one that did not reverse would leave nine.
    assert error_of(fit, 1) == pytest.approx([0.0, OFFSET], abs=3e-4)


def test_readings_far_off_are_left_out() -> None:
    angle = coasting()
    readings = read(angle)
    readings[::100] += 0.5
    fit = fitted_motion(readings, TIME, [slice(0, TIME.size)])
    assert not fit.usable[::100].any()
    assert error_of(fit, 1) == pytest.approx([0.0, OFFSET], abs=2e-4)


def test_a_jerk_is_set_aside() -> None:
    """A drive that takes the shaft from one speed to another in a tenth of a second."""
    speed = 60.0 + 60.0 / (1.0 + np.exp(-(TIME - 3.0) / 0.02))
    angle = np.concatenate([[0.0], np.cumsum(0.0005 * (speed[1:] + speed[:-1]))])
    (sweep,) = sweeps_of([Spin.from_columns({"time_s": TIME, "measured_deg": np.degrees(read(angle))})])
    assert sweep.estimated is not None
    assert sweep.time_s is not None
    assert not np.any(np.abs(sweep.time_s - 3.0) < 0.05)
    assert len(sweep) > 0.85 * TIME.size
    assert len(sweep.estimated.lengths) == 2


def test_each_of_two_logs_has_a_noise_and_a_motion_of_its_own() -> None:
    """The slow one is ten times as noisy and wanders: what the fast one tells of the sensor stays as sure as it is."""
    phases = np.random.default_rng(5).uniform(0.0, 2.0 * np.pi, 6)
    wander = sum(0.02 * np.cos(2.0 * np.pi * (0.3 + 0.2 * k) * TIME + phase) for k, phase in enumerate(phases))
    logs = []
    for seed, (speed, way, noise) in enumerate(((12.0, wander, 10.0 * NOISE), (120.0, 0.0, NOISE))):
        angle = speed * TIME + way
        turned = angle - 100.0 * np.cos(6.0 * angle) / (6.0 * np.gradient(angle, TIME)) ** 2
        read_rad = (
            turned + 0.002 * np.sin(6.0 * turned) + noise * np.random.default_rng(seed).standard_normal(TIME.size)
        )
        logs.append(Spin.from_columns({"time_s": TIME, "measured_deg": np.degrees(read_rad)}))
    slow, fast = sweeps_of(logs)
    assert slow.estimated is not None
    assert fast.estimated is not None
    assert slow.estimated.noise_rad > 8.0 * NOISE
    assert fast.estimated.noise_rad == pytest.approx(NOISE, rel=0.2)
    torque = fast.estimated.torques[5]
    assert np.hypot(torque.cos_rad_s2, torque.sin_rad_s2) == pytest.approx(100.0, rel=0.05)
    assert torque.separable


def two_speeds(*, slow: float = 12.0, fast: float = 120.0) -> MotionFit:
    """Two stretches that waver by a twentieth, the slow one the longer; torques of order 2 grow with the speed."""
    times, angles, begins = [], [], 0.0
    for speed, rows in ((slow, TIME), (fast, TIME[:4000])):
        angle = speed * (rows + 0.05 * np.sin(rows))
        rate = np.gradient(angle, rows)
        angles.append(angle - (20.0 + rate) * np.cos(2.0 * angle) / (2.0 * rate) ** 2)
        times.append(rows + begins)
        begins = float(times[-1][-1]) + 1.0
    return fitted_motion(read(np.concatenate(angles)), np.concatenate(times), [slice(0, 6000), slice(6000, 10000)])


def test_what_grows_with_the_speed_takes_a_third_one() -> None:
    assert np.all(np.isinf(two_speeds().growing))


def test_what_is_not_told_to_grow_is_taken_to_by_about_half_in_the_mean_square() -> None:
    """By half at the slow speed would be five times as much as does not grow at the fast one."""
    fit = two_speeds()
    torque, growing = fit.terms.sd[2 * HIGHEST_ORDER + 2], fit.terms.sd[4 * HIGHEST_ORDER + 2]
    assert 0.3 * torque < growing * np.sqrt(np.mean(fit.speed_rad_s**2)) < torque


def test_two_logs_of_one_speed_each_tell_together_what_neither_tells() -> None:
    slow, fast = 40.0 * TIME, 100.0 * TIME
    logs = [
        Spin.from_columns({"time_s": TIME, "measured_deg": np.degrees(read(angle, seed=seed))})
        for seed, angle in enumerate((slow, fast))
    ]
    for log in logs:
        (alone,) = sweeps_of([log])
        assert alone.estimated is not None
        assert not any(torque.separable for torque in alone.estimated.torques)
    for sweep in sweeps_of(logs):
        assert sweep.estimated is not None
        assert all(torque.separable for torque in sweep.estimated.torques[:4])


def test_directions_that_are_loose_are_whitened_as_their_covariance_says() -> None:
    rng = np.random.default_rng(3)
    columns = 0.05 * rng.standard_normal((3, 400))
    loose = Loose(columns, np.ones(400, dtype=bool), 0.01)
    covariance = 0.01**2 * np.eye(400) + columns.T @ columns
    whitened = loose.whitened(covariance)
    assert np.allclose(loose.whitened(whitened.T), 0.01**2 * np.eye(400), atol=1e-10)


def test_directions_are_loose_beside_a_motion_as_their_common_covariance_says() -> None:
    """What a torque does is told where the motion leaves it to: one after the other would whiten neither."""
    rows, slow, noise = 400, 12, 0.01
    motion = np.minimum((slow / np.arange(1e-3, rows)) ** 6, 1e6)
    basis = to_cosine(np.eye(rows), (rows,)).T
    beside = noise**2 * (basis.T @ ((1.0 + motion)[:, None] * basis))
    columns = 0.05 * np.cos(np.pi * np.array([6.0, 30.0])[:, None] * np.arange(rows) / rows).sum(axis=0, keepdims=True)
    loose = Loose(columns, np.ones(rows, dtype=bool), noise, motion, (rows,))
    left = loose.whitened(loose.whitened(beside + columns.T @ columns).T)
    weights = 1.0 / np.sqrt(1.0 + motion)
    white = (weights[:, None] * weights) * (basis @ left @ basis.T)
    assert np.allclose(white, noise**2 * np.eye(rows), atol=1e-3 * noise**2)


def test_torques_weigh_in_a_fit_as_noise_and_motion_leave_them_to() -> None:
    """Order 1 at the slow speed is slower than the motion is free: there the readings tell next to nothing of it."""
    (sweep,) = sweeps_of([Spin.from_columns({"time_s": TIME, "measured_deg": np.degrees(read(driven(3.0, order=1)))})])
    assert sweep.estimated is not None
    freer = replace(sweep.estimated, knee_rad=np.full(len(sweep), 0.08))
    observations = collect(replace(sweep, estimated=freer))
    columns = torque_columns(observations.motion)
    weights = 1.0 / (freer.noise_rad * np.sqrt(1.0 + freer.spectrum))
    alone = weights * to_cosine(columns, freer.lengths)
    beside = weights * observables_to_cosine(observations, without_nuisance(observations, columns[:, None]))[:, 0]
    told = alone @ alone.T
    assert np.allclose(beside @ beside.T, told @ np.linalg.inv(np.eye(len(told)) + told), atol=1e-3)


def test_a_line_is_matched_to_the_residual_as_both_whitened_are() -> None:
    rng = np.random.default_rng(4)
    motion = np.minimum((12.0 / np.arange(1e-3, 400)) ** 6, 1e6)
    loose = Loose(0.05 * rng.standard_normal((3, 400)), np.ones(400, dtype=bool), 0.01, motion, (400,))
    line, residual = rng.standard_normal((2, 400))
    weighed = to_rows(to_cosine(loose.whitened(residual), (400,)) / (1.0 + motion), (400,))
    assert line @ loose.matched(weighed) == pytest.approx(loose.whitened(line) @ weighed, rel=1e-9)


def test_rows_out_of_use_lose_what_the_others_tell() -> None:
    wave = 0.05 * np.cos(np.arange(400) / 9.0)[None]
    use = np.arange(400) < 300
    left = Loose(wave, use, 1e-4).whitened(0.3 * wave[0])
    assert np.max(np.abs(left[~use])) < 1e-3 * 0.3 * 0.05


def test_what_is_known_to_grow_no_more_leaves_an_error_better_known() -> None:
    """Two speeds without the way between them, which tell nothing of a torque that grows with the speed."""
    columns = draw("two_speeds", seed=440220981).logs[0].columns
    rows = np.arange(columns["time_s"].size)
    calm = (rows < 0.4 * rows.size) | (rows >= 0.65 * rows.size)
    readings, time = np.unwrap(np.radians(columns["measured_deg"]))[calm], columns["time_s"][calm]
    first = int(np.count_nonzero(rows[calm] < 0.4 * rows.size))
    stretches = [slice(0, first), slice(first, time.size)]
    free, held = (fitted_motion(readings, time, stretches, **most) for most in ({}, {"most_growing": np.full(4, 1e-4)}))
    assert np.isinf(free.growing).all()
    # Not told, it is taken to be there: the most of what then is open. Without the limit both are the same.
    assert held.terms.covariance[0, 0] < 0.5 * free.terms.covariance[0, 0]


DAMPED = 8.0
"""Rate [1/s] at which a drive holds its speed."""


def driven(torque: float, *, order: int, fast: float = 80.0) -> np.ndarray:
    """A drive that holds 30 rad/s and after 3 s goes over to a faster speed, by the equation of motion."""
    steps, angle, speed, out = 10, 0.0, 30.0, np.empty(TIME.size)
    step = 0.001 / steps
    for row, time in enumerate(TIME):
        out[row] = angle
        wanted = 30.0 + (fast - 30.0) * float(np.clip((time - 3.0) / 0.3, 0.0, 1.0))
        for _ in range(steps):
            pull = DAMPED * (wanted - speed) + torque * np.cos(order * angle)
            speed += step * pull
            angle += step * speed
    return out


def test_how_a_shaft_goes_over_to_a_speed_tells_how_it_answers_to_a_torque() -> None:
    """Two speeds alone tell nothing of it: order 1 has two coefficients at each, and as many are asked."""
    fit = fitted(driven(3.0, order=1))
    assert fit.damping_per_s == pytest.approx(DAMPED, abs=4.0 * fit.damping_sd_per_s)
    assert fit.damping_sd_per_s < 0.1 * DAMPED
    # Taken for undamped, the torque's phase is off by 15 deg at the slow speed: 0.0009 rad.
    assert error_of(fit, 1) == pytest.approx([0.0, OFFSET], abs=2.5e-4)


def test_of_an_even_motion_no_damping_is_told() -> None:
    angles = [speed * TIME - 10.0 * np.cos(3.0 * speed * TIME) / (3.0 * speed) ** 2 for speed in (40.0, 100.0)]
    logs = [
        Spin.from_columns({"time_s": TIME, "measured_deg": np.degrees(read(angle, seed=seed))})
        for seed, angle in enumerate(angles)
    ]
    found = sweeps_of(logs)[0].estimated
    assert found is not None
    assert found.damping_per_s == 0.0
    torque = found.torques[2]
    assert np.hypot(torque.cos_rad_s2, torque.sin_rad_s2) == pytest.approx(10.0, abs=3.0 * torque.sd_rad_s2)


def test_a_torque_is_as_well_known_as_the_damping() -> None:
    (sweep,) = sweeps_of([Spin.from_columns({"time_s": TIME, "measured_deg": np.degrees(read(driven(3.0, order=1)))})])
    found = sweep.estimated
    assert found is not None
    assert found.damping_sd_per_s > 0.0
    slower = torque_columns(sweep.motion())[-1]
    # To the first order in damping over speed: the torque's angle, turned by so much.
    assert np.max(np.abs(slower)) == pytest.approx(3.0 / 30.0**3 * found.damping_sd_per_s, rel=0.3)


def test_a_strong_torque_is_no_error_of_twice_its_order() -> None:
    """Order 8 by 0.4 deg at the slow speed makes 0.009 deg of the order 16, which falls as 1/speed^4."""
    angle = driven(423.0, order=8, fast=55.0)
    noise = 0.1 * NOISE * np.random.default_rng(1).standard_normal(angle.size)
    fit = fitted_motion(angle + noise, TIME, [slice(0, TIME.size)])
    assert error_of(fit, 16) == pytest.approx([0.0, 0.0], abs=1e-5)
