"""Corrections that follow the temperature: selective, as good between the measured temperatures, the same in C."""

from __future__ import annotations

import io
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from diagnosis.correction.calibration import Calibration, calibrate, calibrate_over_temperature
from diagnosis.correction.compensation import Correction, Drift, correction_of, correction_over
from diagnosis.correction.compensation_c import header
from diagnosis.correction.correction_file import from_dict, to_dict
from diagnosis.correction.cross_validation import between, cross_validated
from diagnosis.error_model.model import VY
from diagnosis.thermal.laws import SENSITIVE
from diagnosis.thermal.levels import levels_of
from diagnosis.thermal.recording import joined
from scenarios.commands import compensate
from scenarios.commands.compensate_table import table
from scenarios.commands.protocol import Protocol
from tests.diagnosis.correction.c_program import run_header
from tests.diagnosis.thermal.devices import COLD_ROOM_HOT, over, warm
from twin.angles import TAU, Array, wrap
from twin.chain import Chain
from twin.errors import UserError
from twin.motion import Motion
from twin.sweep import Sweep

BETWEEN = (-20.0, 0.0, 60.0)
LOW, HIGH = COLD_ROOM_HOT[0], COLD_ROOM_HOT[-1]


@cache
def measured() -> Sweep:
    return warm().simulate(over(COLD_ROOM_HOT), seed=1)


@cache
def calibrated() -> Calibration:
    return calibrate_over_temperature(joined([measured()]), rng=np.random.default_rng(0))


@cache
def selective() -> Correction:
    return correction_over(calibrated().at, LOW, HIGH)


def readings(temperature_c: float) -> tuple[Array, Array]:
    """Shaft and noiseless reading [rad] at a temperature."""
    shaft = TAU * np.arange(500) / 500
    motion = Motion.from_angle(shaft, temperature_c=np.full(500, temperature_c))
    return shaft, warm().without("noise").readings(motion)


def rms_deg(error: Array) -> float:
    return float(np.degrees(np.sqrt(np.mean(wrap(error) ** 2))))


@pytest.mark.parametrize("temperature", [*COLD_ROOM_HOT, *BETWEEN])
def test_error_at_each_temperature_and_between_them(temperature: float) -> None:
    shaft, reading = readings(temperature)
    # Eight terms and a few orders from 540 readings of 0.02 deg: 0.02 sqrt(16/540) = 0.0034 deg.
    assert rms_deg(selective().shaft(reading, temperature) - shaft) < 0.005
    at_one = calibrate(*(np.radians(c) for c in (measured().reference_deg, measured().measured_deg)), rng=rng())
    averaged = rms_deg(correction_of(at_one.chain).shaft(reading) - shaft)
    if abs(temperature - 25.0) > 24.0:
        assert averaged > 0.04


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def test_factors_that_are_not_sensitive_are_constant() -> None:
    found = calibrated()
    assert found.over is not None
    sensitive = np.array([law.verdict == SENSITIVE for law in found.over.factors])
    assert sensitive.tolist() == [True, False, True, False, False, False]
    moves = found.coefficients[:, 1:].any(axis=1)
    np.testing.assert_array_equal(moves, sensitive)
    drift = selective().drift
    assert drift is not None
    # Offset x and gain are orders 1 and 2; with 37 deg of zero in both parts. What little is above comes of products.
    assert drift.series.shape[2] <= 4
    sizes = np.hypot(*drift.series[0])
    assert sizes[:2].min() > 20.0 * sizes[2:].max(initial=0.0)


def test_beyond_the_measured_temperatures_it_stays_what_it_is_there() -> None:
    reading = TAU * np.arange(50) / 50
    for beyond, end in ((-90.0, LOW), (150.0, HIGH)):
        np.testing.assert_array_equal(selective().shaft(reading, beyond), selective().shaft(reading, end))
    assert rms_deg(selective().shaft(reading, LOW) - selective().shaft(reading, HIGH)) > 0.1


def test_each_reading_may_have_its_own_temperature() -> None:
    reading = TAU * np.arange(60) / 60
    temperature = np.linspace(LOW, HIGH, 60)
    one_by_one = [float(selective().shaft(reading[k : k + 1], temperature[k])[0]) for k in range(60)]
    np.testing.assert_allclose(selective().shaft(reading, temperature), one_by_one, atol=1e-12)


def test_a_twin_is_undone_over_a_span_whatever_the_law() -> None:
    """Also where products of drifts bend the correction, and where 25 C lies outside of the span."""
    twin = warm().without("noise").with_effect("offset_drift", x_percent_per_K=0.1, y_percent_per_K=-0.08)
    shaft = TAU * np.arange(400) / 400
    for low, high in ((-40.0, 125.0), (60.0, 120.0)):
        correction = correction_over(lambda _: twin, low, high, tolerance_deg=1e-3)
        for temperature in np.linspace(low, high, 7):
            reading = twin.readings(Motion.from_angle(shaft, temperature_c=np.full(400, temperature)))
            left = wrap(correction.shaft(reading, temperature) - shaft)
            # The tolerance holds for orders, for what follows the temperature, and for the polynomial: each once.
            assert np.degrees(np.max(np.abs(left))) < 3e-3


def test_toml_says_the_same() -> None:
    back = from_dict(to_dict(selective()))
    reading = TAU * np.arange(100) / 100
    for temperature in (LOW, 10.0, HIGH):
        np.testing.assert_allclose(
            wrap(back.shaft(reading, temperature) - selective().shaft(reading, temperature)), 0.0, atol=1e-12
        )
    assert "drift" not in to_dict(correction_of(warm()))


def test_straight_lines_between_the_table_rows_stay_within_the_tolerance() -> None:
    rows = np.genfromtxt(io.StringIO(table(selective(), 16, 1e-3)), delimiter=",", names=True)
    temperatures = np.unique(rows["temperature_c"])
    assert temperatures[[0, -1]].tolist() == [LOW, HIGH]
    shaft = rows["shaft_deg"].reshape(temperatures.size, 16)
    middle = 0.5 * (temperatures[0] + temperatures[1])
    line = shaft[0] + 0.5 * ((shaft[1] - shaft[0] + 180.0) % 360.0 - 180.0)
    truth = np.degrees(selective().shaft(TAU * np.arange(16) / 16, middle))
    assert np.max(np.abs((line - truth + 180.0) % 360.0 - 180.0)) < 1.1e-3
    assert table(correction_of(warm()), 16, 1e-3).startswith("reading_deg,")


BENT = Drift(-40.0, 85.0, np.array([2e-5, -3e-7]), np.full((2, 2, 3), [[[1e-5]], [[2e-7]]]))
ZERO_ALONE = Drift(30.0, 85.0, np.array([2e-5]), np.zeros((1, 2, 0)))


@pytest.mark.parametrize("drift", [None, BENT, ZERO_ALONE], ids=["measured", "bent", "zero alone"])
def test_compiled_header_is_the_python_correction(drift: Drift | None, tmp_path: Path) -> None:
    base = selective()
    correction = base if drift is None else Correction(-1, 1.0, base.series, (), 0.0, drift)
    draw = np.random.default_rng(0)
    words = draw.integers(0, 2**32, 2000).astype(np.float64)
    temperature_mc = draw.integers(-60_000, 110_000, 2000)
    found = run_header(header(correction, source="a test", prefix="test"), words, tmp_path, temperature_mc)
    expected = correction.shaft(words / 2.0**32 * TAU, temperature_mc / 1000.0)
    assert np.degrees(np.max(np.abs(wrap(found[:, 0] / 2.0**32 * TAU - expected)))) < 5e-6


def test_header_refuses_a_drift_that_does_not_fit() -> None:
    huge = Drift(-40.0, 85.0, np.zeros(1), np.full((1, 2, 60), 0.01))
    with pytest.raises(UserError, match="too large"):
        header(Correction(1, 0.0, np.zeros((2, 60)), (), 0.0, huge), source="")


def test_held_out_blocks_and_a_held_out_temperature() -> None:
    recording = joined([measured()])
    level = levels_of(recording).of_reading
    counted = np.zeros(len(recording))

    def correct(part):  # type: ignore[no-untyped-def]
        counted[: len(part)] += 1.0
        found = calibrate_over_temperature(part, rng=rng())
        return correction_over(found.at, found.span.low_c, found.span.high_c).shaft

    found = cross_validated(recording, level, correct)
    for k in range(3):
        before, after = found.among(level == k).rms_deg
        assert before > 0.35
        assert after < 0.023
    alone = between(recording, level, lambda rows: correct(recording.part(rows)))
    assert list(alone) == [1]
    # Half of the readings less: 0.02 sqrt(1 + 16/360).
    assert alone[1].rms_deg[1] < 0.023
    assert alone[1].before_rad.size == np.count_nonzero(level == 1)
    # Five folds of four fifths of the readings, and one of two thirds.
    assert counted[0] == 6
    assert counted[-1] == 0


def mirrored_words(sensor: Chain, *, channels: bool, capsys: pytest.CaptureFixture[str], folder: Path) -> str:
    motion = Protocol(turns=1, points=72, temperatures_c=COLD_ROOM_HOT, channels=channels).motion()
    sensor.simulate(motion, seed=1).write(folder / "warm.csv")
    compensate.run([folder / "warm.csv"], outputs=compensate.Outputs(toml=folder / "c.toml", force=True))
    return " ".join(capsys.readouterr().out.split())


def test_factors_that_the_mirror_solution_turns_are_told_as_open(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Beside the correction stand laws of the factors, of which two have a sign that no quadratic term tells here."""
    plain = warm().without("quadratic_nonlinearity")
    assert "which way the output counts is open" in mirrored_words(
        plain, channels=False, capsys=capsys, folder=tmp_path
    )
    for sensor, channels in ((plain, True), (warm(), False)):
        shown = mirrored_words(sensor, channels=channels, capsys=capsys, folder=tmp_path)
        assert "offset y, % immune -0.7" in shown
        assert "is open" not in shown


def test_either_mirror_solution_makes_the_same_correction_over_temperature() -> None:
    """They differ by what noise makes of order 3: 0.02 deg sqrt(2/540) of an order's amplitude, four of them."""
    made = joined([warm().without("quadratic_nonlinearity").simulate(over(COLD_ROOM_HOT), seed=1)])
    found = [calibrate_over_temperature(made, rng=rng(), senses=(way, way)) for way in (1, -1)]
    fresh = TAU * np.arange(500) / 500
    for temperature in COLD_ROOM_HOT:
        shafts = [correction_of(one.at(temperature)).shaft(fresh) for one in found]
        assert np.degrees(np.max(np.abs(wrap(shafts[0] - shafts[1])))) < 4 * 0.0012
    laws = [one.over.factors for one in found if one.over is not None]
    assert laws[0][VY].at_25.value == pytest.approx(-laws[1][VY].at_25.value, abs=1e-4)
