"""The converter of [hardware.converter]: one description, run in expectation and as built."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scenarios.commands.protocol import Protocol
from twin.adc.converter import Converter, convert, instants
from twin.angles import Array, wrap
from twin.chain import Chain
from twin.errors import UserError
from twin.files import SCHEMA, from_dict, to_dict
from twin.hardware import run
from twin.parts import Parts

SPINNING = Protocol(turns=2, points=720, speeds_rpm=(600.0,)).motion()
FULL = Converter(
    bits=12,
    full_scale=1.5,
    gap_s=20e-6,
    aperture_s=1e-6,
    droop_per_s=100.0,
    reference_rms=2e-4,
    ripple=1e-3,
    ripple_Hz=37.0,
    noise_rms=1e-3,
    inl_lsb=6.0,
    dnl_lsb=0.1,
    part=3,
    latency_s=50e-6,
)


def with_(converter: Converter) -> Chain:
    return Chain(parts=Parts(converter=converter))


def second_harmonic_deg(chain: Chain) -> float:
    error = chain.error(SPINNING)
    return float(np.degrees(2.0 * np.abs(np.mean(error * np.exp(-2j * SPINNING.shaft_rad)))))


def test_the_expected_channels_are_the_mean_of_those_as_built() -> None:
    chain, records = with_(FULL), 400
    found = np.mean([chain.channels(SPINNING, np.random.default_rng(k)) for k in range(records)], axis=0)
    # The noise of 1e-3 dithers steps of 7e-4. What the step widths, which walk by 0.1 step each, add is a part's own:
    # up to 0.1 sqrt(2^12) / 2 steps, or 2e-3; left out here, so that all that stays is the noise of the mean.
    flat = with_(replace(FULL, dnl_lsb=0.0))
    plain = np.mean([flat.channels(SPINNING, np.random.default_rng(k)) for k in range(records)], axis=0)
    scatter = np.hypot(1e-3, FULL.step / np.sqrt(12.0)) / np.sqrt(records)
    np.testing.assert_allclose(plain, flat.channels(SPINNING), atol=5.0 * scatter)
    walk = found - plain
    assert 0.2 * FULL.step < np.std(walk) < 3.2 * FULL.step


@pytest.mark.parametrize(
    ("converter", "share"),
    [
        # y is lower by the droop while x is converted; a share of y turns the angle by half of it, order 2.
        (Converter(bits=16, gap_s=50e-6, droop_per_s=200.0), 0.5 * 200.0 * 50e-6),
        # At 600 rpm, 62.8 rad/s, y is sampled 3.1e-3 rad later: half of it is order 2, as of an angle of the axes.
        (Converter(bits=16, gap_s=50e-6), 0.5 * 20.0 * np.pi * 50e-6),
    ],
    ids=["droop", "gap"],
)
def test_what_waiting_does_to_y(converter: Converter, share: float) -> None:
    apart = with_(converter)
    gap = 0.5 * 20.0 * np.pi * converter.gap_s
    expected = np.degrees(np.hypot(gap, share) if converter.droop_per_s else share)
    assert second_harmonic_deg(apart) == pytest.approx(expected, rel=0.02)


def test_the_aperture_spreads_the_readings_with_the_speed() -> None:
    chain = with_(Converter(bits=20, aperture_s=20e-6))
    reading = chain.simulate(SPINNING, seed=1).measured_deg
    rms = np.std(wrap(np.radians(reading) - chain.readings(SPINNING)))
    # Both channels jitter by themselves, each weighing with the square of the other: mean of cos^4 + sin^4 is 3/4.
    assert rms == pytest.approx(20.0 * np.pi * 20e-6 * np.sqrt(0.75), rel=0.1)


def test_hardware_shows_the_codes_of_the_chain() -> None:
    chain = with_(FULL)
    rng = np.random.default_rng(5)
    late = instants(np.zeros(len(SPINNING)), FULL, rng) - FULL.latency_s
    angle = SPINNING.shaft_rad + late * SPINNING.speed_rad_s
    start: Array = np.stack([SPINNING.time_s, SPINNING.time_s + FULL.gap_s])
    codes = convert(np.stack([np.cos(angle[0]), np.sin(angle[1])]), start, FULL, rng)
    np.testing.assert_array_equal(run(chain, SPINNING, np.random.default_rng(5)).codes, codes)


def test_it_is_written_read_and_seen_in_the_mirror() -> None:
    chain = with_(FULL)
    assert from_dict(to_dict(chain)).parts == chain.parts
    apart = wrap(chain.mirrored().readings(SPINNING) - chain.readings(SPINNING))
    np.testing.assert_allclose(apart, 0.0, atol=1e-12)
    with pytest.raises(UserError, match=r"give it as \[effects\.adc_stuck_bit\]"):
        from_dict({"schema": SCHEMA, "hardware": {"converter": {"stuck_bit": 3}}})
