"""What the diagnoser says beside the values: null space, profiles, mirror, equivalents, raw channels, air gaps."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.error_model.fit import fit_baseline
from diagnosis.error_model.model import NOMINAL, Readings
from diagnosis.factors.channels import fit_curve, output_sense
from diagnosis.factors.findings import curve_deg, quantify_many
from diagnosis.factors.identifiability import identifiability
from diagnosis.factors.mechanical import mechanical
from diagnosis.factors.null_space import HIDDEN, invisible_count, paper_jacobian
from tests.diagnosis.cases import NOISE_RAD, measured, turn
from twin.angles import TAU, Array
from twin.chain import Chain
from twin.motion import Motion
from twin.sweep import Sweep

POINT: Array = np.array([0.008, -0.005, 1.01, 0.008, 0.002, 0.7])


def sweep_of(chain: Chain, readings: int = 360, *, channels: bool = False, seed: int = 0) -> Sweep:
    motion = Motion.from_angle(TAU * np.arange(readings) / readings, has_channels=channels)
    return chain.simulate(motion, seed=seed)


def device() -> Chain:
    return (
        Chain()
        .with_effect("offset", x_percent=0.8, y_percent=-0.5)
        .with_effect("gain_mismatch", ratio=1.01)
        .with_effect("quadratic_nonlinearity", q_percent=0.2)
        .with_effect("noise", rms_deg=0.02)
    )


def paper_curve(unknowns: Array, angle: Array) -> Array:
    """Eq. 1, 2 and 4 with all ten unknowns, as they are printed."""
    vx, ax, vy, ay, beta, k1, k2, k3, mag, zero = unknowns

    def f(c: Array) -> Array:
        return k1 * mag**2 * c**2 + k2 * mag * c + k3

    a = angle + zero
    return np.arctan2(vy + ay * f(np.cos(a - np.pi / 2 + beta)), vx + ax * f(np.cos(a)))


def test_the_four_hidden_changes_leave_every_angle_as_it_is() -> None:
    angle = turn(50)
    base = np.array([0.01, 1.02, -0.02, 0.97, 0.01, 1.9e-7, 0.01, 0.003, 100.0, 0.4])
    vx, ax, vy, ay, beta, k1, k2, k3, mag, zero = base
    changed = [
        [2 * vx, 2 * ax, 2 * vy, 2 * ay, beta, k1, k2, k3, mag, zero],
        [vx, ax / 2, vy, ay / 2, beta, 2 * k1, 2 * k2, 2 * k3, mag, zero],
        [vx, ax, vy, ay, beta, k1 / 4, k2 / 2, k3, 2 * mag, zero],
        [vx - 0.1 * ax, ax, vy - 0.1 * ay, ay, beta, k1, k2, k3 + 0.1, mag, zero],
    ]
    assert len(changed) == len(HIDDEN) == invisible_count(POINT)
    for other in changed:
        np.testing.assert_allclose(paper_curve(np.array(other), angle), paper_curve(base, angle), atol=1e-12)


def test_paper_jacobian_is_the_difference() -> None:
    """Where K2 mag = 1 and K3 = 0: the visible parameters of the ten unknowns, by differences."""
    base = np.array([0.008, 1.0, -0.005 * 1.01, 1.01, 0.008, 2e-7, 0.01, 0.0, 100.0, 0.7])

    def visible(u: Array) -> Array:
        unit = u[6] * u[8]
        return np.array(
            [
                u[0] / (u[1] * unit) + u[7] / unit,
                u[2] / (u[3] * unit) + u[7] / unit,
                u[3] / u[1],
                u[4],
                u[5] * u[8] / u[6],
                u[9],
            ]
        )

    jacobian = paper_jacobian(visible(base))
    for k, size in enumerate(np.maximum(np.abs(base), 1e-3)):
        step = np.zeros(10)
        step[k] = 1e-6 * size
        by_hand = (visible(base + step) - visible(base - step)) / (2e-6 * size)
        np.testing.assert_allclose(jacobian[:, k], by_hand, rtol=1e-5, atol=1e-6 * np.abs(by_hand).max())


def test_profile_of_a_weak_parameter_agrees_with_its_interval() -> None:
    point = POINT.copy()
    point[4] = 0.0
    reference = turn(360)
    reading = measured(point, reference, noise=NOISE_RAD * np.random.default_rng(0).standard_normal(360))
    fit = fit_baseline(reference, reading, rng=np.random.default_rng(0), senses=(1, 1))
    found = identifiability(fit, reference, reading)
    (profile,) = found.profiles
    assert profile.name == "quad"
    assert profile.low == pytest.approx(fit.low[4], abs=0.05 * fit.standard_errors[4])
    assert profile.high == pytest.approx(fit.high[4], abs=0.05 * fit.standard_errors[4])
    assert any("quadratic term: not told from 0, that of an ideal sensor" in words for words in found.sentences)
    assert not found.unseen


def test_an_arc_is_said_to_be_an_arc() -> None:
    reference = np.linspace(0.0, 1.6, 200)
    reading = measured(NOMINAL, reference, noise=1e-3 * np.random.default_rng(0).standard_normal(200))
    found = identifiability(fit_baseline(reference, reading, rng=np.random.default_rng(0)), reference, reading)
    assert found.covered_deg == pytest.approx(92.0, abs=1.0)
    assert any("cover 92 deg" in words for words in found.sentences)
    assert any("tied to one another" in words or "do not see" in words for words in found.sentences)


@pytest.mark.parametrize(("readings", "said"), [(8, "2 degrees of freedom"), (7 + 7, "8 degrees"), (6 + 9, "")])
def test_few_readings_are_said_to_be_few(readings: int, said: str) -> None:
    """Student's t of two degrees of freedom is 4.30 at 97.5 %, the normal distribution 1.96."""
    reference = turn(readings)
    reading = measured(POINT, reference, noise=NOISE_RAD * np.random.default_rng(0).standard_normal(readings))
    fit = fit_baseline(reference, reading, rng=np.random.default_rng(0), senses=(1, 1))
    words = " ".join(one for one in identifiability(fit, reference, reading).sentences if "few readings" in one)
    assert said in words
    assert bool(words) == bool(said)
    assert readings != 8 or "2.2 times as wide" in words


def test_mechanical_equivalents_are_what_was_simulated() -> None:
    reference = turn(360)
    chain = Chain().with_effect("magnet_misalignment", off_axis_mm=0.4, direction_deg=30.0)
    chain = chain.with_effect("stray_field", bx_mT=0.3, by_mT=-0.2)
    fit = fit_baseline(
        reference, chain.readings(Motion.from_angle(reference)), rng=np.random.default_rng(0), senses=(1, 1)
    )
    found = mechanical(fit)
    assert found.off_axis_mm == pytest.approx(0.4, abs=1e-3)
    assert found.off_axis_direction_deg == pytest.approx(30.0, abs=0.5)
    assert (found.stray_x_mT, found.stray_y_mT) == (pytest.approx(0.3, rel=0.02), pytest.approx(-0.2, rel=0.02))
    tilted = Chain().with_effect("magnet_misalignment", tilt_deg=found.tilt_deg, direction_deg=found.tilt_direction_deg)
    other = fit_baseline(
        reference, tilted.readings(Motion.from_angle(reference)), rng=np.random.default_rng(0), senses=(1, 1)
    )
    np.testing.assert_allclose(other.point[2:4], fit.point[2:4], atol=2e-4)


def test_no_misalignment_reaches_a_gain_ratio_of_two() -> None:
    point = NOMINAL.copy()
    point[2] = 2.0
    fit = fit_baseline(turn(360), measured(point, turn(360)), rng=np.random.default_rng(0), senses=(1, 1))
    found = mechanical(fit)
    assert found.off_axis_mm is None
    assert found.tilt_deg is None


def test_channels_part_the_reference_from_the_sensor() -> None:
    chain = device().with_effect("reference_eccentricity", amplitude_deg=0.3, phase_deg=20.0)
    found = quantify_many([sweep_of(chain, channels=True)])[0]
    assert found.added is not None
    assert found.added.beyond_order_1_deg == pytest.approx(0.3, abs=0.02)
    assert any("eccentricity" in words for words in found.sentences)
    assert found.added.curve.values[2:4] == pytest.approx([1.0, 1.01], abs=1e-3)
    quiet = quantify_many([sweep_of(device(), channels=True)])[0]
    assert any("the reference adds nothing" in words for words in quiet.sentences)


def test_curve_and_sense_from_channels() -> None:
    angle = turn(200)
    x, y = Readings.of(angle, angle).channels(POINT)
    found = fit_curve(1000.0 * x, 1000.0 * y)
    np.testing.assert_allclose(found.point()[:5], POINT[:5], atol=1e-6)
    assert found.amplitude == pytest.approx(1005.0, rel=1e-6)
    assert output_sense(np.arctan2(y, x), x, y) == 1
    assert output_sense(-np.arctan2(y, x), x, y) == -1


def test_repeated_angles_are_not_independent() -> None:
    rng = np.random.default_rng(0)
    reference = np.repeat(turn(16), 10)
    jig = np.repeat(np.radians(0.1) * rng.standard_normal(16), 10)
    reading = measured(POINT, reference, noise=jig + NOISE_RAD * rng.standard_normal(160))
    sweep = Sweep.from_columns({"reference_deg": np.degrees(reference), "measured_deg": np.degrees(reading)})
    found = quantify_many([sweep])[0]
    assert found.repeated is not None
    assert "16 different angles" in found.repeated
    assert found.fit.degrees_of_freedom == 10
    single = fit_baseline(reference, reading, rng=rng)
    assert np.all(found.fit.standard_errors > 2.0 * single.standard_errors)


def test_curve_is_the_error_of_the_fit() -> None:
    sweep = sweep_of(device())
    found = quantify_many([sweep])[0]
    error = sweep.measured_deg - sweep.reference_deg - found.fit.values["zero"]["zero_deg"]
    left = (error - curve_deg(found.fit, sweep.reference_deg) + 180.0) % 360.0 - 180.0
    np.testing.assert_allclose(left, np.degrees(found.fit.residual_rad), atol=1e-9)


def test_many_agree_with_one() -> None:
    sweeps = [sweep_of(device(), 90 + 10 * (k % 2), channels=k == 2, seed=k) for k in range(4)]
    for many, sweep in zip(quantify_many(sweeps), sweeps, strict=True):
        one = quantify_many([sweep])[0]
        assert many.sweep is sweep
        np.testing.assert_allclose(many.fit.point, one.fit.point, atol=1e-8)


@pytest.mark.parametrize("wild", [12.0, -1e3, 1e9])
def test_one_wild_reading_of_a_channel_among_few_ends_in_figures(wild: float) -> None:
    """What it pulls at leaves some direction open; the figures stay finite."""
    angle = np.arange(12) * np.pi / 6.0
    x, y = np.cos(angle), np.sin(angle)
    x[7] = wild
    found = fit_curve(x, y)
    assert np.all(np.isfinite([*found.values, *found.standard_errors, found.rms_relative]))
