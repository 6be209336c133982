"""The hardware end to end, and that the chain of effects is what it comes down to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scenarios.commands.protocol import Protocol
from twin.adc.converter import Converter
from twin.angles import wrap
from twin.chain import Chain
from twin.concentrator.disk import Disk
from twin.cordic.bit_true import Cordic
from twin.hall.spinning_current import Plate, residual_offset_mT
from twin.hardware import Hardware, run
from twin.limits import OutOfRangeError
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement

TURN = Protocol(points=720).motion()
FINE = {
    "converter": Converter(bits=20),
    "cordic": Cordic(iterations=22, word_bits=20, guard_bits=8, angle_bits=30),
    "angle_bits": 16,
}
PERFECT = Plate(asymmetry=0.0, settling_s=0.0)
RIGID = 1e4
"""Saturation [mT] of a disk that hardly saturates: (100 / 1e4)^2 / 12 of a radian is 5e-4 deg."""
SLACK_RAD = np.radians(1e-3)
"""That, the rounding of 20 bits (7e-5 deg) and what 22 iterations leave (3e-5 deg)."""
STEP_RAD = 2.0 * np.pi / 2**16


def error(hardware: Hardware, seed: int | None = None) -> np.ndarray:
    received = run(hardware, TURN, None if seed is None else np.random.default_rng(seed)).received_rad
    return wrap(received - TURN.shaft_rad)


def test_perfect_hardware_reads_the_angle() -> None:
    hardware = Hardware(disk=Disk(saturation_mT=RIGID), plates=(PERFECT, PERFECT), **FINE)
    assert np.max(np.abs(error(hardware))) < 0.5 * STEP_RAD + SLACK_RAD


def test_the_chain_of_effects_is_what_the_hardware_comes_down_to() -> None:
    disk = Disk(shift_x_um=3.0, shift_y_um=-2.0, roughness_um=0.2, part=5)
    plates = (Plate(settling_s=0.0, asymmetry=0.02), Plate(settling_s=0.0, asymmetry=-0.01))
    assembly = Assembly(Magnet(), Placement(air_gap_mm=2.5, sensor_x_mm=0.3, magnet_y_mm=0.2))
    hardware = Hardware(assembly=assembly, disk=disk, plates=plates, **FINE)
    offsets = [residual_offset_mT(plate)[1] / (disk.gain * assembly.nominal_mT) for plate in plates]
    x, y = np.linalg.norm(disk.conversion, axis=1) / disk.gain
    # The chain puts the disk's turn into the field angle, the hardware into the plates: the same for a small turn of
    # an aligned magnet, and to the product of turn and misalignment for this one.
    chain = (
        Chain(magnet=assembly)
        .with_effect("zero", zero_deg=-disk.axis_deg)
        .with_effect("phase", beta_deg=disk.orthogonality_deg)
        .with_effect("saturation", k_percent=disk.k_percent(assembly.nominal_mT))
        .with_effect("offset", x_percent=100.0 * offsets[0] / x, y_percent=100.0 * offsets[1] / y)
        .with_effect("gain_mismatch", ratio=disk.ratio)
    )
    expected = chain.error(TURN)
    assert np.degrees(np.max(np.abs(expected))) > 0.3
    assert np.degrees(np.max(np.abs(wrap(error(hardware) - expected)))) < 0.01


def test_a_moving_shaft_shows_latency_and_the_gap_between_conversions() -> None:
    motion = Protocol(points=720, speeds_rpm=(600.0,)).motion()
    converter = Converter(bits=20, gap_s=10e-6, latency_s=100e-6)
    hardware = Hardware(disk=Disk(saturation_mT=RIGID), plates=(PERFECT, PERFECT), **{**FINE, "converter": converter})
    chain = Chain().with_effect("latency", delay_us=100.0).with_effect("xy_skew", delay_us=10.0)
    ours = wrap(run(hardware, motion).received_rad - motion.shaft_rad)
    assert np.max(np.abs(wrap(ours - chain.error(motion)))) < 0.5 * STEP_RAD + SLACK_RAD


def test_frames_carry_every_word_and_noise_spreads_them() -> None:
    hardware = Hardware()
    quiet, noisy = run(hardware, TURN), run(hardware, TURN, np.random.default_rng(1))
    assert quiet.sound.all()
    assert noisy.sound.all()
    assert quiet.can.shape == (720, 34 + 8 * 4)
    assert 0.0 < np.degrees(np.std(wrap(noisy.received_rad - quiet.received_rad))) < 0.1
    again = run(hardware, TURN, np.random.default_rng(1))
    assert again.received_rad.tobytes() == noisy.received_rad.tobytes()


def test_fourteen_bits_and_fourteen_iterations_stay_within_their_bounds() -> None:
    hardware = replace(Hardware(), disk=Disk(saturation_mT=RIGID), plates=(PERFECT, PERFECT))
    radius = 0.8 * 2**13 - 1
    # Half a step of each channel, the CORDIC's bound, half a step of the word.
    bound = np.sqrt(0.5) / radius + hardware.cordic.bound_rad(radius) + np.pi / 2**14
    assert np.max(np.abs(error(hardware))) < bound


def test_refuses_word_lengths_that_do_not_fit() -> None:
    with pytest.raises(
        OutOfRangeError, match="word_bits of the CORDIC is 10 bit; expected at least the converter's 14"
    ):
        Hardware(cordic=Cordic(word_bits=10))
    with pytest.raises(OutOfRangeError, match="angle_bits is 20 bit; expected a whole number from 1 to 16 bit"):
        Hardware(angle_bits=20)
