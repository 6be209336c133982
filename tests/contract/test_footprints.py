"""What effects promise that do not show on the mean: spreads, sets of values, single readings, and each turn's zero."""

from __future__ import annotations

import numpy as np
import pytest

from scenarios.commands.protocol import Protocol
from twin.angles import TAU, wrap
from twin.catalogue import find
from twin.chain import Chain
from twin.cordic.cordic_truncation import attainable
from twin.example import full_motion

MOTION = full_motion()
LONG = Protocol(turns=40, points=360, channels=False).motion()
"""14,400 readings: a standard deviation of independent readings is known to 0.6 % (1 sigma)."""


def simulated_error(chain: Chain, seed: int = 1) -> np.ndarray:
    sweep = chain.simulate(LONG, seed=seed)
    return wrap(np.radians(sweep.measured_deg - sweep.reference_deg))


def test_noise_has_the_stated_rms() -> None:
    error = simulated_error(Chain().with_effect("noise", rms_deg=0.1))
    assert np.degrees(np.std(error)) == pytest.approx(0.1, rel=0.03)  # 5 sigma


def test_noise_is_correlated_as_stated() -> None:
    error = simulated_error(Chain().with_effect("noise", rms_deg=0.1, correlation=0.8))
    # 5 sigma of a correlation coefficient of so many readings, widened for their own correlation.
    assert np.corrcoef(error[1:], error[:-1])[0, 1] == pytest.approx(0.8, abs=0.05)


def test_jitter_follows_its_declared_spread() -> None:
    effect = find("reference_jitter")
    assert effect.spread is not None
    error = simulated_error(Chain().with_effect("reference_jitter", percent_rms=0.5))
    declared = effect.spread(LONG.shaft_rad, {"percent_rms": 0.5})
    strong = declared > 0.5 * declared.max()
    assert np.mean(error[strong] ** 2) == pytest.approx(np.mean(declared[strong]), rel=0.1)  # 5 sigma of a variance
    assert np.max(np.abs(error[declared < 1e-20])) < 1e-9


def test_converter_rounds_each_channel_by_half_a_step_at_most() -> None:
    bits = 10
    channels = Chain().with_effect("adc_quantisation", bits=bits).channels(MOTION, np.random.default_rng(0))
    step = 2.5 / 2**bits
    exact = np.stack([np.cos(MOTION.shaft_rad), np.sin(MOTION.shaft_rad)])
    assert np.max(np.abs(channels - exact)) <= 0.5 * step * (1 + 1e-9)
    np.testing.assert_allclose(channels / step, np.round(channels / step), atol=1e-9)


@pytest.mark.parametrize("bits", [8, 11, 14])
def test_words_lie_on_the_grid(bits: int) -> None:
    angle = Chain().with_effect("output_quantisation", bits=bits).readings(MOTION)
    step = TAU / 2**bits
    np.testing.assert_allclose(angle / step, np.round(angle / step), atol=1e-7)
    assert np.max(np.abs(wrap(angle - MOTION.shaft_rad))) <= 0.5 * step * (1 + 1e-9)


@pytest.mark.parametrize("iterations", [6, 9, 12])
def test_cordic_returns_only_attainable_angles(iterations: int) -> None:
    angle = wrap(Chain().with_effect("cordic_truncation", iterations=iterations).readings(MOTION))
    allowed = attainable({"iterations": iterations})
    nearest = np.min(np.abs(wrap(angle[:, None] - allowed[None, :])), axis=1)
    assert np.max(nearest) < 1e-9
    assert np.max(np.abs(wrap(angle - MOTION.shaft_rad))) <= np.arctan(2.0 ** -(iterations - 1)) + 1e-12


def test_glitches_flip_one_bit_of_as_many_words_as_stated() -> None:
    clean, hit = (Chain().with_effect("bus_glitch", count=n).simulate(LONG, seed=2).measured_deg for n in (0, 9))
    jump = np.abs(wrap(np.radians(hit - clean)))
    touched = jump > 1e-9
    assert np.count_nonzero(touched) == 9
    power = np.log2(TAU / jump[touched])
    np.testing.assert_allclose(power, np.round(power), atol=1e-6)


def test_stale_frames_repeat_the_stated_share() -> None:
    sweep = Chain().with_effect("stale_frames", fraction_percent=5.0).simulate(LONG, seed=2)
    repeated = np.mean(np.diff(sweep.measured_deg) == 0.0)
    assert repeated == pytest.approx(0.05, abs=5 * np.sqrt(0.05 * 0.95 / len(LONG)))


def test_each_turn_has_its_own_zero() -> None:
    zeros = np.array([0.1, -0.2, 0.3, 0.0, 0.0, 0.4, -0.1, 0.2] * 2)
    error = Chain().with_effect("reference_rezero", zeros_deg=zeros).error(MOTION)
    np.testing.assert_allclose(np.degrees(error), -zeros[MOTION.turn], atol=1e-9)
    drawn = np.degrees(simulated_error(Chain().with_effect("reference_rezero", spread_deg=0.3)))
    by_turn = [drawn[LONG.turn == turn] for turn in range(40)]
    assert max(np.ptp(part) for part in by_turn) < 1e-9
    # 40 zeros: their standard deviation is known to 11 % (1 sigma).
    assert np.std([part[0] for part in by_turn], ddof=1) == pytest.approx(0.3, rel=0.45)


def test_a_burst_is_noisy_between_its_rows_alone() -> None:
    error = simulated_error(Chain().with_effect("unnamed_burst", rms_deg=0.3, first_row=1000, last_row=6000))
    assert np.max(np.abs(error[:999])) < 1e-9
    assert np.degrees(np.std(error[1001:5999])) == pytest.approx(0.3, rel=0.06)  # 5 sigma
