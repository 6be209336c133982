"""Effects that are a line: order or frequency, amplitude and phase as a spectrum of the simulated error shows them."""

from __future__ import annotations

import numpy as np
import pytest

from twin.angles import TAU
from twin.catalogue import find
from twin.chain import Chain
from twin.motion import Motion

COUNT = 1000
AMPLITUDE_DEG, PHASE_DEG = 0.2, 35.0
ROUNDING_DEG = 1e-10


def phasors_deg(error_rad: np.ndarray) -> np.ndarray:
    """Amplitude [deg] times exp(i phase) of each whole number of cycles in the record; a cosine's phase, at row 0."""
    return np.asarray(np.fft.rfft(np.degrees(error_rad)) * 2.0 / error_rad.size)


# Orders: bearing_wobble's is not whole in one turn, but is in the hundred turns of the record.
@pytest.mark.parametrize(
    ("name", "params", "cycles", "sign"),
    [
        ("magnet_harmonic", {"order": 5.0}, 5, 1.0),
        ("drive_ripple", {"order": 50.0}, 50, 1.0),
        ("cardan_coupling", {}, 2, 1.0),
        ("reference_eccentricity", {}, 1, -1.0),
        ("unnamed_order", {"order": 11.0}, 11, 1.0),
        ("bearing_wobble", {"order": 0.41}, 41, 1.0),
    ],
)
def test_a_line_over_the_shaft(name: str, params: dict[str, float], cycles: int, sign: float) -> None:
    turns = 100 if name == "bearing_wobble" else 1
    motion = Motion.from_angle(np.arange(COUNT) * turns * TAU / COUNT)
    chain = Chain().with_effect(name, amplitude_deg=AMPLITUDE_DEG, phase_deg=PHASE_DEG, **params)
    found = phasors_deg(chain.error(motion))
    # A sine of the phase is a cosine a quarter of a turn behind it.
    assert found[cycles] == pytest.approx(sign * AMPLITUDE_DEG * np.exp(1j * np.radians(PHASE_DEG - 90.0)), rel=0.02)
    # What the effect does acts on an angle that it has itself moved: some 0.2 deg times the order of that.
    rest = np.delete(np.abs(found), cycles)
    assert np.max(rest) < 0.02 * AMPLITUDE_DEG


def test_a_tone_in_time() -> None:
    """7 Hz over 10 s, on a shaft that turns at another pace; its phase is that in the middle of the record."""
    time_s = np.arange(COUNT + 1) * 0.01
    motion = Motion.from_angle(time_s * TAU * 1.3, time_s=time_s)
    chain = Chain().with_effect("unnamed_tone", frequency_Hz=7.0, amplitude_deg=AMPLITUDE_DEG, phase_deg=PHASE_DEG)
    error = chain.error(motion)
    assert np.degrees(error[COUNT // 2]) == pytest.approx(AMPLITUDE_DEG * np.cos(np.radians(PHASE_DEG)), abs=1e-9)
    found = phasors_deg(error[:-1])
    # The middle is 35 whole periods after the first row.
    assert found[70] == pytest.approx(AMPLITUDE_DEG * np.exp(1j * np.radians(PHASE_DEG)), abs=ROUNDING_DEG)
    assert np.max(np.delete(np.abs(found), 70)) < ROUNDING_DEG


@pytest.mark.parametrize("level", [0.0, 1.0])
def test_a_stuck_bit_is_a_square_wave_in_the_channels_value(level: float) -> None:
    """Half the values are a step off, those whose bit is not what it is held at; the other half are right."""
    step = 0.04
    motion = Motion.from_angle(np.arange(COUNT) * TAU / COUNT)
    chain = Chain().with_effect("adc_stuck_bit", step_percent=100.0 * step, level=level)
    ideal = np.stack([np.cos(motion.shaft_rad), np.sin(motion.shaft_rad)])
    moved = (chain.channels(motion) - ideal) / step
    # The mean belongs to the offset, so the two values lie half a step to either side.
    np.testing.assert_allclose(np.abs(moved), 0.5, atol=1e-9)
    order = np.argsort(ideal[0])
    # Along the channel's value, from -1 to 1, the sign changes once a step: 2 / 0.04 times, and one for the ends.
    assert np.count_nonzero(np.diff(np.sign(moved[0][order]))) == pytest.approx(2.0 / step, abs=1)
    # The middle of the code is a whole number of double steps, so the bit is zero on the step above it, one on the step
    # below. Held at one the first reads a step too much, held at zero the second a step too little.
    volts = ideal[0] - step * (level - 0.5)
    near = np.abs(volts) < step
    np.testing.assert_array_equal(np.sign(moved[0][near]), np.where(volts[near] >= 0.0, 1.0, -1.0))


@pytest.mark.parametrize("level", [0, 1])
def test_the_lower_bits_make_up_for_a_bit_that_is_stuck_inside_the_approximation(level: int) -> None:
    """Against the approximation itself, bit after bit; what it shifts in the mean, a quarter of the bit, is offset."""
    bits, stuck = 16, 10
    value = np.linspace(20_000.3, 44_000.3, 3001)
    held = np.zeros_like(value)
    for bit in range(bits - 1, -1, -1):
        on = np.full(value.size, bool(level)) if bit == stuck else value >= held + 2.0**bit
        held += np.where(on, 2.0**bit, 0.0)
    step = 2.0**stuck / 2.0 ** (bits - 1)
    # The codes count from the lowest one; mid-scale is no signal.
    signal = value / 2.0 ** (bits - 1) - 1.0
    mean = step * (0.25 if level else -0.25)
    params = {"step_percent": 100.0 * step, "level": float(level), "in_approximation": 1.0, "blur_percent": 0.0}
    rest = Motion.from_angle(np.zeros(value.size))
    found = find("adc_stuck_bit").forward(np.stack([signal + mean] * 2), rest, params, None)
    # A code stands for all values up to the next one.
    assert np.max(np.abs(found[0] - (held / 2.0 ** (bits - 1) - 1.0))) <= 2.0 ** (1 - bits) * (1.0 + 1e-9)


@pytest.mark.parametrize(("number", "power"), [(0, 8 / np.pi**2), (1, 8 / np.pi**2), (2, 0.683), (3, 0.683)])
def test_the_waves_of_a_stuck_bit_are_its_fundamentals(number: int, power: float) -> None:
    """In phase; of the power of a square it has 8 / pi^2, of half a saw's, 5 / 48, half of 4 / pi^4 + 1 / pi^2."""
    effect = find("adc_stuck_bit")
    assert effect.line is not None
    phase, form = effect.line.waves[number]
    value = np.linspace(-1.0, 1.0, 4000, endpoint=False)
    rest = Motion.from_angle(np.zeros(value.size))
    values = {"step_percent": 1.0, **form}
    wave = effect.forward(0.01 * value, rest, values, None) - 0.01 * value
    fundamental = 2.0 * np.mean(wave * np.exp(-1j * np.pi * value))
    assert fundamental / abs(fundamental) == pytest.approx(phase, abs=2e-3)
    assert 0.5 * abs(fundamental) ** 2 / np.var(wave) == pytest.approx(power, abs=0.002)
