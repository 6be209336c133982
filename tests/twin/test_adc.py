"""The converter: rounding, jitter, reference, linearity; the sine fit that judges them."""

from __future__ import annotations

import numpy as np
import pytest

from tests.twin.sine_fit import fit_sine, ideal_sinad_db, jitter_sinad_db
from twin.adc.converter import Converter, convert, instants, linearity, sample
from twin.angles import TAU, Array
from twin.limits import OutOfRangeError

RATE_HZ = 1e5
COUNT = 1 << 16
TONE_HZ = 1237.0 / COUNT * RATE_HZ
"""1,237 whole cycles, a prime: every sample meets another phase."""


def tone(at_s: Array) -> Array:
    return np.asarray(np.stack([np.cos(TAU * TONE_HZ * at_s[0]), np.sin(TAU * TONE_HZ * at_s[1])]))


def sinad_of(converter: Converter, *, seed: int | None = 1, scale: float = 1.0) -> tuple[float, float]:
    """SINAD [dB] and ENOB of the x channel, driven to full scale."""
    rng = None if seed is None else np.random.default_rng(seed)
    amplitude = scale * (converter.full_scale - converter.step)
    codes, _ = sample(lambda at: amplitude * tone(at), np.arange(COUNT) / RATE_HZ, converter, rng)
    fit = fit_sine(codes[0] * converter.step, RATE_HZ, TONE_HZ * (1 + 1e-6))
    return fit.sinad_db, fit.enob(2.0 * converter.full_scale)


def five_sigma_db(kurtosis: float) -> float:
    """Five standard deviations [dB] of a noise power from COUNT samples: var = (kurtosis - 1) power^2 / n."""
    return float(5.0 * 10.0 / np.log(10.0) * np.sqrt((kurtosis - 1.0) / COUNT))


@pytest.mark.parametrize("bits", [8, 10, 12, 14, 16])
def test_an_ideal_converter_has_its_bits(bits: int) -> None:
    sinad, enob = sinad_of(Converter(bits=bits), seed=None)
    # Uniform error: kurtosis 1.8. The sine stays a step below full scale. Below 10 bits the error of rounding a sine
    # is not quite uniform (long stretches at the peaks): 0.1 dB more.
    short = 20.0 * np.log10(1.0 - 2.0 / 2**bits)
    slack = five_sigma_db(1.8) + (0.1 if bits < 10 else 0.0)
    assert sinad == pytest.approx(ideal_sinad_db(bits) + short, abs=slack)
    assert ideal_sinad_db(bits) == pytest.approx(6.02 * bits + 1.76, abs=0.02)
    assert enob == pytest.approx(bits, abs=slack / 6.02)


@pytest.mark.parametrize("aperture_s", [2e-8, 2e-7, 2e-6])
def test_jitter_limits_as_the_formula_says(aperture_s: float) -> None:
    sinad, _ = sinad_of(Converter(bits=18, aperture_s=aperture_s))
    # Gaussian times a cosine: kurtosis 3 * (3/8) / (1/4) = 4.5; rounding at 18 bits adds nothing here. The second
    # order of the jitter, (2 pi f t)^2 / 2 of the amplitude, is below 1e-3 dB.
    assert sinad == pytest.approx(jitter_sinad_db(TONE_HZ, aperture_s), abs=five_sigma_db(4.5))


def test_rounding_and_jitter_add_as_powers() -> None:
    aperture = 3e-8
    sinad, _ = sinad_of(Converter(bits=12, aperture_s=aperture))
    power = sum(10.0 ** (-part / 10.0) for part in (ideal_sinad_db(12), jitter_sinad_db(TONE_HZ, aperture)))
    assert sinad == pytest.approx(-10.0 * np.log10(power), abs=five_sigma_db(4.5))


def test_noise_of_the_reference_is_relative() -> None:
    sinad, _ = sinad_of(Converter(bits=18, reference_rms=1e-3))
    # The noise follows the signal: rms 1e-3 of its rms. Kurtosis as for jitter; 1e-3 of the gain is 0.01 dB.
    assert sinad == pytest.approx(60.0, abs=five_sigma_db(4.5) + 0.01)


def test_ripple_of_the_reference_makes_side_lines() -> None:
    converter = Converter(bits=18, ripple=1e-3, ripple_Hz=100.0 / COUNT * RATE_HZ)
    codes, _ = sample(lambda at: tone(at), np.arange(COUNT) / RATE_HZ, converter)
    lines = np.abs(np.fft.rfft(codes[0] * converter.step)) * 2.0 / COUNT
    np.testing.assert_allclose(lines[[1137, 1337]], 0.5e-3, rtol=1e-2)


def test_sequential_conversion_and_droop() -> None:
    converter = Converter(bits=20, gap_s=5e-6, droop_per_s=20.0)
    time = np.arange(1000) / RATE_HZ
    np.testing.assert_allclose(np.diff(instants(time, converter), axis=0)[0], 5e-6, rtol=1e-9)
    codes, ready = sample(lambda at: tone(at), time, Converter(bits=20, gap_s=5e-6, droop_per_s=20.0, latency_s=1e-5))
    late = np.sin(TAU * TONE_HZ * (time + 5e-6)) * (1.0 - 1e-4)
    np.testing.assert_allclose(codes[1] * converter.step, late, atol=converter.step)
    np.testing.assert_allclose(ready - time, 1e-5, rtol=1e-6)


def test_bow_and_step_widths_show_as_inl_and_dnl() -> None:
    inl, dnl = linearity(Converter(bits=12))
    assert np.max(np.abs(inl)) < 1e-9
    assert np.max(np.abs(dnl)) < 1e-9
    inl, _ = linearity(Converter(bits=12, inl_lsb=3.0))
    assert np.max(np.abs(inl)) == pytest.approx(3.0, rel=0.01)
    _, dnl = linearity(Converter(bits=12, dnl_lsb=0.1, part=4))
    # 4,095 widths: their standard deviation is known to 1.1 %.
    assert np.std(dnl) == pytest.approx(0.1, rel=0.06)
    clean, bowed = (sinad_of(Converter(bits=14, inl_lsb=bow), seed=None)[0] for bow in (0.0, 8.0))
    assert bowed < clean - 10.0


def test_straight_transitions_and_rounding_agree() -> None:
    ideal, nearly = Converter(bits=10), Converter(bits=10, inl_lsb=1e-12)
    values = np.random.default_rng(3).uniform(-1.5, 1.5, (2, 5000))
    at = np.zeros_like(values)
    np.testing.assert_array_equal(convert(values, at, ideal), convert(values, at, nearly))


def test_clips_and_sticks() -> None:
    converter = Converter(bits=8)
    values = np.array([[-9.0, 9.0, 0.0], [-1.25, 1.2499, 0.3]])
    codes = convert(values, np.zeros_like(values), converter)
    assert codes.min() == -128
    assert codes.max() == 127
    stuck = convert(values, np.zeros_like(values), Converter(bits=8, stuck_bit=3, stuck_at=1))
    assert np.all((stuck + 128) & 8)
    np.testing.assert_array_equal((stuck + 128) & ~8, (codes + 128) & ~8)


def test_the_fit_finds_a_sine_it_is_not_told() -> None:
    time = np.arange(5000) / RATE_HZ
    record = 0.2 + 0.7 * np.cos(TAU * 1234.5 * time)
    fit = fit_sine(record, RATE_HZ, 1236.0)
    assert fit.frequency_Hz == pytest.approx(1234.5, rel=1e-9)
    assert fit.amplitude == pytest.approx(0.7, rel=1e-9)
    assert fit.offset == pytest.approx(0.2, rel=1e-9)
    assert fit.residual_rms < 1e-9


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"bits": 0}, "bits is 0 bit; expected a whole number from 1 to 20 bit"),
        ({"aperture_s": float("nan")}, "aperture_s is nan s; expected from 0 to 1 s"),
        ({"reference_rms": -0.1}, "reference_rms is -0.1; expected from 0 to 0.5"),
        ({"bits": 8, "stuck_bit": 8}, "stuck_bit is 8; expected a whole number from 0 to 7"),
    ],
)
def test_refuses_by_name_value_and_range(options: dict[str, float], message: str) -> None:
    with pytest.raises(OutOfRangeError) as refused:
        Converter(**options)  # type: ignore[arg-type]
    assert str(refused.value) == message
