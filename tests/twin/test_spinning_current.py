"""Spinning current: what it removes, what it leaves, and where the noise goes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from twin.hall.spinning_current import (
    TYPICAL,
    corner_and_error,
    corner_of,
    density,
    flicker,
    residual_offset_mT,
    spin,
)
from twin.limits import OutOfRangeError


def test_a_symmetric_plate_has_no_offset_left() -> None:
    plate = replace(TYPICAL, asymmetry=0.0, settling_s=0.0)
    before, after = residual_offset_mT(plate)
    # Plate, thermoelectric and amplifier: (1000 + 5 + 500) uV over 100 uV/mT.
    assert before == pytest.approx(15.05, rel=1e-9)
    assert abs(after) < 1e-12


def test_what_is_left_is_the_difference_between_the_phases() -> None:
    plate = replace(TYPICAL, settling_s=0.0)
    _, after = residual_offset_mT(plate)
    assert after == pytest.approx(0.5 * plate.asymmetry * plate.offset_uV / plate.sensitivity_uV_per_mT, rel=1e-9)
    before, after = residual_offset_mT(TYPICAL)
    assert abs(after) < 0.001 * abs(before)


def test_one_current_sense_alone_keeps_the_thermoelectric_voltage() -> None:
    traced = spin(np.zeros(2), replace(TYPICAL, asymmetry=0.0, settling_s=0.0))
    forth = traced.demodulated_uV[1, :2].mean()
    back = traced.demodulated_uV[1, 2:].mean()
    assert forth == pytest.approx(5.0)
    assert back == pytest.approx(-5.0)


def test_the_field_passes_and_the_sensitivity_drifts() -> None:
    plate = replace(TYPICAL, asymmetry=0.0, settling_s=0.0)
    field = np.array([0.0, 10.0, -20.0])
    np.testing.assert_allclose(spin(field, plate).output_mT, field, atol=1e-9)
    hot = spin(field, plate, temp_c=125.0)
    assert np.ptp(hot.demodulated_uV.mean(axis=(1, 2))) == pytest.approx(30.0 * 100.0 * 1.05)


def test_slow_settling_costs_gain() -> None:
    # The phases change the Hall voltage's sign: what settles from the phase before comes off twice.
    plate = replace(TYPICAL, asymmetry=0.0, thermal_uV=0.0, settling_s=1e-6, blanking=0.0, samples=256)
    gain = spin(np.full(4, 1.0), plate).output_mT[-1]
    lost = 2.0 * plate.settling_s / plate.phase_s * (1.0 - np.exp(-plate.phase_s / plate.settling_s))
    assert gain == pytest.approx(1.0 - lost, rel=1e-3)
    # Sampled in the second half of each phase, of 2.5 to 5 time constants, most of it is gone.
    assert spin(np.full(4, 1.0), replace(plate, blanking=0.5)).output_mT[-1] > 1.0 - 0.4 * lost


def test_noise_has_the_stated_density() -> None:
    plate = TYPICAL
    rate = 1e6
    frequency, power = density(flicker(np.random.default_rng(2), 1 << 18, rate, plate), rate, segments=255)
    stated = (1e-3 * plate.white_nV) ** 2 * (1.0 + plate.corner_Hz / frequency)
    # 255 half-overlapping segments: about 6 % a line; the mean of the ratio over 900 lines to 1 %.
    assert np.mean(power / stated) == pytest.approx(1.0, abs=0.02)
    assert corner_of(frequency, power) == pytest.approx(plate.corner_Hz, rel=0.05)


def test_a_corner_scatters_as_its_error_says() -> None:
    plate, rate = TYPICAL, 2e5
    drawn = [
        corner_and_error(*density(flicker(np.random.default_rng(seed), 1 << 15, rate, plate), rate))
        for seed in range(40)
    ]
    corners, errors = np.array(drawn).T
    # The scatter of forty is known to 1/sqrt(80), 11 %: two and a half of these.
    assert np.std(corners, ddof=1) == pytest.approx(errors.mean(), rel=0.28)
    assert abs(corners.mean() - plate.corner_Hz) < 3.0 * errors.mean() / np.sqrt(len(corners))


def test_spinning_moves_the_corner_and_leaves_the_white_noise() -> None:
    plate = TYPICAL
    noisy = spin(np.zeros(1 << 14), plate, np.random.default_rng(1))
    before, after = (density(values, plate.cycle_Hz) for values in (noisy.unspun_mT, noisy.output_mT))
    # Leaving out half of the samples doubles the white noise of the output, not the slow 1/f noise; the mean over a
    # cycle bends the upper end of the band. Together they move the fitted corner to half, within some 20 %.
    assert corner_of(*before) == pytest.approx(plate.corner_Hz * (1.0 - plate.blanking), rel=0.3)
    assert corner_of(*after) < 0.01 * plate.corner_Hz
    # White noise through the mean over a cycle: its density stays, plus what the chopper folds down from 1/f.
    # Half of the samples are left out, and with them half of the averaging.
    white = (1e-3 * plate.white_nV / plate.sensitivity_uV_per_mT) ** 2 / (1.0 - plate.blanking)
    low = after[1][: after[1].size // 4].mean()
    assert white < low < 1.6 * white


def test_same_seed_same_bytes() -> None:
    one, two = (spin(np.zeros(8), TYPICAL, np.random.default_rng(3)).output_mT for _ in range(2))
    assert one.tobytes() == two.tobytes()


def test_refuses_by_name_value_and_range() -> None:
    with pytest.raises(OutOfRangeError, match=r"phase_s is -1 s; expected from 1e-09 to 1 s"):
        replace(TYPICAL, phase_s=-1.0)
