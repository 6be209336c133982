"""Corrections: inverse of the twin, C header against Python, held-out error, real sensors against look-up tables."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

from diagnosis.correction.calibration import calibrate
from diagnosis.correction.compensation import Correction, correction_of
from diagnosis.correction.compensation_c import header, sine_polynomial
from diagnosis.correction.correction_file import from_dict, to_dict
from diagnosis.correction.cross_validation import against, cross_validated, folds
from diagnosis.error_model.model import twin_values
from diagnosis.thermal.recording import Recording
from tests.benchmarks.compensation import FILES, POINTS, look_up_table, mean_of_draws
from tests.diagnosis.cases import NOISE_RAD, measured, points, senses, turn
from tests.diagnosis.correction.c_program import run_header
from tests.measured import REAL
from twin.angles import TAU, Array, wrap
from twin.chain import Chain
from twin.errors import UserError
from twin.motion import Motion
from twin.sweep import Sweep


def rich_chain() -> Chain:
    return (
        Chain(sensor_sense=-1)
        .with_effect("zero", zero_deg=77.0)
        .with_effect("offset", x_percent=3.0, y_percent=-2.0)
        .with_effect("gain_mismatch", ratio=1.15)
        .with_effect("phase", beta_deg=3.0)
        .with_effect("saturation", k_percent=1.0)
    )


@given(points(), senses)
@settings(max_examples=20, deadline=None, derandomize=True)
def test_undoes_the_twin(point: Array, pair: tuple[int, int]) -> None:
    chain = Chain(values=twin_values(point), sensor_sense=pair[0], output_sense=pair[1])
    shaft = turn(500)
    correction = correction_of(chain, tolerance_deg=1e-3)
    back = correction.shaft(chain.readings(Motion.from_angle(shaft)))
    # The worst of the range needs more orders than there are: 64 leave 0.02 deg at 30 % offset and a ratio of 2.
    assert np.degrees(np.max(np.abs(wrap(back - shaft)))) < max(1.5e-3, 1.5 * np.degrees(correction.tolerance_rad))


def test_leaves_out_what_one_reading_cannot_tell() -> None:
    chain = rich_chain().with_effect("noise", rms_deg=0.1).with_effect("zero_drift", amplitude_deg=1.0)
    chain = chain.with_effect("hysteresis", lag_deg=0.1, memory_deg=8.0)
    correction = correction_of(chain)
    assert set(correction.left_out) == {"noise", "zero_drift"}
    shaft = turn(500)
    back = correction.shaft(rich_chain().readings(Motion.from_angle(shaft)))
    # Hysteresis is corrected to the middle of both directions.
    assert np.degrees(np.max(np.abs(wrap(back - shaft)))) < 1.5e-3


def test_toml_and_table_say_the_same() -> None:
    correction = correction_of(rich_chain())
    back = from_dict(to_dict(correction))
    reading = turn(100)
    np.testing.assert_allclose(wrap(back.shaft(reading) - correction.shaft(reading)), 0.0, atol=1e-12)
    table = correction.table(256)
    assert table.shape == (256,)
    np.testing.assert_allclose(table, correction.shaft(TAU * np.arange(256) / 256))


def test_sine_polynomial_is_good_to_nine_digits() -> None:
    t = np.linspace(-1.0, 1.0, 2001)
    powers = t[:, None] ** (2 * np.arange(6) + 1)
    np.testing.assert_allclose(powers @ sine_polynomial(), np.sin(0.5 * np.pi * t), atol=1e-9)


@pytest.mark.parametrize("chain", [Chain(), rich_chain(), Chain().with_effect("gain_mismatch", ratio=1.9)])
def test_compiled_header_is_the_python_correction(chain: Chain, tmp_path: Path) -> None:
    correction = correction_of(chain)
    edges = [0.0, 2.0**30, 2.0**31, 3 * 2.0**30, 2.0**32 - 1, 1.0]
    words = np.concatenate([np.random.default_rng(0).integers(0, 2**32, 5000).astype(np.float64), edges])
    found = run_header(header(correction, source="a test", prefix="test"), words, tmp_path)
    expected = correction.shaft(words / 2.0**32 * TAU)
    assert np.degrees(np.max(np.abs(wrap(found[:, 0] / 2.0**32 * TAU - expected)))) < 5e-6
    short = correction.shaft(np.floor(words / 2.0**16) / 2.0**16 * TAU)
    # A 16-bit word is rounded to 360/65536 deg.
    assert np.degrees(np.max(np.abs(wrap(found[:, 1] / 2.0**16 * TAU - short)))) < 0.51 * 360 / 65536


def test_header_refuses_what_does_not_fit() -> None:
    with pytest.raises(UserError, match="begins no C name"):
        header(correction_of(Chain()), source="", prefix="3d")
    huge = Correction(1, 0.0, np.full((2, 60), 0.5), (), 0.0)
    with pytest.raises(UserError, match="too large"):
        header(huge, source="")


def test_calibration_finds_orders_where_they_are_and_none_where_not() -> None:
    rng = np.random.default_rng(0)
    reference = turn(180)
    chain = rich_chain().with_effect("magnet_harmonic", order=7, amplitude_deg=0.05)
    motion = Motion.from_angle(reference)
    reading = chain.readings(motion) + NOISE_RAD * rng.standard_normal(180)
    found = calibrate(reference, reading, rng=rng)
    fresh = turn(999)
    truth = chain.readings(Motion.from_angle(fresh))
    left = wrap(found.chain.readings(Motion.from_angle(fresh)) - truth)
    # 20 or so figures from 180 readings of 0.02 deg: 0.02 sqrt(20/180) = 0.007 deg.
    assert np.degrees(np.sqrt(np.mean(left**2))) < 0.009
    plain = calibrate(reference, measured(np.array([0.01, 0.0, 1.0, 0.0, 0.0, 0.2]), reference), rng=rng)
    sizes = [v["amplitude_deg"] for key, v in plain.chain.values.items() if key.startswith("unnamed_order")]
    assert sum(sizes) < 1e-3


@pytest.mark.parametrize("q", [0.0, 0.0005, 0.002])
def test_either_mirror_solution_makes_the_same_correction(q: float) -> None:
    """The two differ in order 3 of the quadratic term, q/sqrt(8): 0.04 deg at q = 0.002. Orders beside it hold that.

    An order's amplitude is known to 0.02 sqrt(2/360) = 0.0015 deg; four of these in all.
    """
    rng = np.random.default_rng(0)
    reference = turn(360)
    reading = measured(np.array([0.008, -0.005, 1.01, 0.006, q, 0.7]), reference)
    reading = reading + NOISE_RAD * rng.standard_normal(360)
    found = [
        correction_of(calibrate(reference, reading, rng=np.random.default_rng(0), senses=(way, way)).chain)
        for way in (1, -1)
    ]
    fresh = turn(999)
    apart = wrap(found[0].shaft(fresh) - found[1].shaft(fresh))
    assert np.degrees(np.max(np.abs(apart))) < 4 * 0.0015


def test_held_out_rows_are_each_held_out_once() -> None:
    for rows in (8, 65, 1000):
        assert np.array_equal(np.sum(list(folds(rows)), axis=0), np.ones(rows))


@pytest.mark.parametrize("there_and_back", [False, True])
def test_no_angle_of_two_turns_is_held_out_twice(there_and_back: bool) -> None:
    """What is held out of one is seen in the other, but for the ends of blocks."""
    place = np.concatenate([np.arange(100), np.arange(100)[:: -1 if there_and_back else 1]])
    for mask in folds(200):
        assert np.intersect1d(place[:100][mask[:100]], place[100:][mask[100:]]).size == 0


def test_held_out_error_of_a_simulated_sweep() -> None:
    rng = np.random.default_rng(1)
    reference = turn(360)
    reading = rich_chain().readings(Motion.from_angle(reference)) + NOISE_RAD * rng.standard_normal(360)

    def correct(part: Recording):  # type: ignore[no-untyped-def]
        chain = calibrate(part.reference_rad, part.measured_rad, rng=np.random.default_rng(0)).chain
        return correction_of(chain).shaft

    recording = Recording.at_one_temperature(reference, reading, 25.0)
    found = cross_validated(recording, recording.unit, correct)
    before, after = found.rms_deg
    assert before > 2.0
    assert after < 0.03
    np.testing.assert_allclose(found.per_turn(np.zeros(360)).rms_deg[1], after, rtol=0.05)


def test_look_up_table_goes_through_its_points() -> None:
    reference = turn(32)
    reading = rich_chain().readings(Motion.from_angle(reference))
    error = against(reference, reading, look_up_table(reference, reading))
    assert error.rms_deg[1] < 1e-9


@pytest.mark.measured
@pytest.mark.parametrize("name", ["jig_hall_sensor2", "jig_hall_sensor3", "oven_b_start1", "room_repeat"])
@pytest.mark.parametrize("count", POINTS)
def test_better_than_a_look_up_table_on_real_sensors(name: str, count: int) -> None:
    ours, table, _ = mean_of_draws(Sweep.read(REAL / f"{name}.csv"), count, draws=4)
    assert ours < 1.03 * table


@pytest.mark.measured
@pytest.mark.study
@pytest.mark.parametrize("name", FILES)
def test_better_than_a_look_up_table_over_more_draws(name: str) -> None:
    sweep = Sweep.read(REAL / f"{name}.csv")
    for count in POINTS:
        ours, table, _ = mean_of_draws(sweep, count, draws=20)
        assert ours < (1.15 if name == "stepper_as5047d_b" else 1.03) * table
