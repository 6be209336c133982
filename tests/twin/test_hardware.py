"""The chain as built: its signals between the stages, its mean, and that the described parts come down to effects."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from scenarios.commands.protocol import Protocol
from twin.angles import Array, wrap
from twin.chain import Chain
from twin.concentrator.disk import Disk, vertical_mT
from twin.cordic.bit_true import Cordic
from twin.files import SCHEMA, TwinError, from_dict, to_dict
from twin.hall import plates
from twin.hall.plates import expected_mT
from twin.hall.spinning_current import TYPICAL, Plate, Spinning, residual_offset_mT, spin
from twin.hardware import run
from twin.limits import OutOfRangeError
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.motion import Motion
from twin.parts import Parts
from twin.presets import preset_names, read_preset

TURN = Protocol(points=720).motion()
SHIFTED = Disk(shift_x_um=3.0, shift_y_um=-2.0, roughness_um=0.2, part=5, saturation_mT=500.0)
RUNS = 10_000
SIGMAS = 4.5
"""Of all 24 angles of four presets the largest deviation of a mean stays within this (7e-6 a comparison)."""


def described(**parts: object) -> Chain:
    return Chain(parts=Parts(**parts))  # type: ignore[arg-type]


# ---- what the view shows --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", preset_names())
def test_hardware_reads_what_simulate_records(name: str) -> None:
    chain = read_preset(name)
    signals = run(chain, TURN, np.random.default_rng(3))
    recorded = np.radians(chain.simulate(TURN, seed=3).columns["measured_deg"])
    half_word = np.pi / 2**signals.bits
    assert np.max(np.abs(wrap(signals.received_rad - recorded))) <= half_word + 1e-9
    assert signals.sound.all()
    assert signals.can.shape == (720, 34 + 8 * 4)


def test_an_ideal_chain_reads_the_angle_and_has_no_codes() -> None:
    signals = run(Chain(), TURN)
    assert signals.codes is None
    assert np.max(np.abs(wrap(signals.received_rad - TURN.shaft_rad))) <= np.pi / 2**16 + 1e-12


def test_signals_count_in_the_described_field_gain_and_sensitivity() -> None:
    chain = described(field_mT=40.0, disk=Disk(gain=3.0), plate=Plate(sensitivity_uV_per_mT=50.0, offset_uV=200.0))
    signals = run(chain.with_effect("offset", x_percent=1.0), TURN)
    np.testing.assert_allclose(np.hypot(*signals.in_plane_mT), 40.0, rtol=1e-12)
    np.testing.assert_allclose(signals.vertical_mT, 3.0 * signals.in_plane_mT, atol=1e-12)
    # One percent of the nominal amplitude, 120 mT under the disk; 200 uV are 4 mT before spinning and nothing after.
    np.testing.assert_allclose(signals.spun_mT[0] - signals.vertical_mT[0], 1.2, atol=1e-12)
    np.testing.assert_allclose(signals.unspun_mT - signals.vertical_mT, 4.0, atol=1e-12)
    np.testing.assert_allclose(signals.voltage_uV, 50.0 * signals.spun_mT, rtol=1e-12)


def test_codes_and_words_are_those_of_the_integer_units() -> None:
    chain = read_preset("imc-14bit")
    signals = run(chain, TURN, np.random.default_rng(1))
    assert signals.codes is not None
    np.testing.assert_allclose(signals.codes * 2.5 / 2**14, signals.amplitude, atol=1e-12)
    unit = Cordic(iterations=16, word_bits=14, guard_bits=3, angle_bits=18)
    steps = signals.computed_rad / (2.0 * np.pi / 2**18)
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    radius = float(np.min(np.hypot(*signals.codes)))
    exact = np.arctan2(signals.codes[1], signals.codes[0])
    assert 0.0 < np.max(np.abs(wrap(signals.computed_rad - exact))) < unit.bound_rad(radius)


# ---- expected is the mean of as built -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", preset_names())
def test_the_expected_reading_is_the_mean_of_those_as_built(name: str) -> None:
    chain = read_preset(name)
    if "cordic_truncation" in chain.values:
        # What is left of stairs behind noise has its own tests; so many iterations and guard bits leave nothing that
        # the mean of 10,000 runs would show.
        chain = chain.with_effect("cordic_truncation", iterations=24, guard_bits=12, angle_bits=30)
    # One quantiser behind another leaves a beat of their steps, up to a tenth of the coarser one, that noise does not
    # smooth: a word as coarse as the converter's is judged by itself.
    chain = chain.without("output_quantisation")
    motion = Motion.from_angle(np.radians(np.arange(3.0, 363.0, 15.0)))
    # One array among the parameters makes a batch of runs, each with noise of its own.
    x = chain.values["offset"]["x_percent"]
    batch = chain.with_values({"offset": {**chain.values["offset"], "x_percent": np.full(RUNS, x)}})
    *_, last = batch.steps(motion, np.random.default_rng(5))
    smooth = chain.without("cordic_truncation").readings(motion)
    away = wrap(last.after[:, 0] - smooth)
    scatter = away.std(axis=0) / np.sqrt(RUNS)
    assert np.max(np.abs(away.mean(axis=0)) / scatter) < SIGMAS


def test_a_noisy_plate_is_right_in_the_mean_and_follows_the_temperature() -> None:
    plate = replace(TYPICAL, settling_s=1e-6, blanking=0.1)
    field, warm = np.repeat([-30.0, 0.0, 45.0], RUNS), np.repeat([-20.0, 25.0, 90.0], RUNS)
    output = spin(field, plate, np.random.default_rng(2), temp_c=warm).output_mT.reshape(3, RUNS)
    expected = expected_mT(field, plate, warm).reshape(3, RUNS)[:, 0]
    assert np.all(np.abs(output.mean(axis=1) - expected) < SIGMAS * output.std(axis=1) / np.sqrt(RUNS))
    # 0.05 % per kelvin over 65 K; settling takes more from the field than from the scale at 25 C.
    assert expected[2] / 45.0 == pytest.approx((1.0 + 0.0005 * 65.0) * (expected[2] / 45.0 / 1.0325), rel=1e-9)
    assert abs(expected[2] - 45.0) > 10.0 * output[2].std() / np.sqrt(RUNS)


# ---- the paper's factors are a projection ---------------------------------------------------------------------------


def test_disk_and_plates_come_down_to_effects() -> None:
    plates = (replace(TYPICAL, asymmetry=0.02, settling_s=0.0), replace(TYPICAL, asymmetry=-0.01, settling_s=0.0))
    assembly = Assembly(Magnet(), Placement(air_gap_mm=2.5, sensor_x_mm=0.3, magnet_y_mm=0.2))
    chain = Chain(magnet=assembly, parts=Parts(disk=SHIFTED, plate=plates[0], plate_y=plates[1]))
    offsets = [residual_offset_mT(plate)[1] / (SHIFTED.gain * assembly.nominal_mT) for plate in plates]
    x, y = np.linalg.norm(SHIFTED.conversion, axis=1) / SHIFTED.gain
    # The effects put the disk's turn into the field angle, the disk itself into the channels: the same for a small turn
    # of an aligned magnet, and to the product of turn and misalignment for this one.
    projected = (
        Chain(magnet=assembly)
        .with_effect("zero", zero_deg=-SHIFTED.axis_deg)
        .with_effect("phase", beta_deg=SHIFTED.orthogonality_deg)
        .with_effect("saturation", k_percent=SHIFTED.k_percent(assembly.nominal_mT))
        .with_effect("offset", x_percent=100.0 * offsets[0] / x, y_percent=100.0 * offsets[1] / y)
        .with_effect("gain_mismatch", ratio=SHIFTED.ratio)
    )
    error = chain.error(TURN)
    assert np.degrees(np.max(np.abs(error))) > 0.3
    assert np.degrees(np.max(np.abs(wrap(error - projected.error(TURN))))) < 0.01


def test_saturation_of_the_vector_turns_no_angle_and_that_of_each_axis_does() -> None:
    whole, each = (described(disk=Disk(saturation_mT=300.0, per_axis=share)) for share in (0.0, 1.0))
    assert np.max(np.abs(whole.error(TURN))) < 1e-12
    assert np.allclose(np.hypot(*whole.channels(TURN)), np.tanh(50.0 / 300.0) / (50.0 / 300.0))
    # k sin 4a / 4 to the leading order, k = (50 / 300)^2 / 3; the next order is that much smaller again.
    k = (50.0 / 300.0) ** 2 / 3.0
    shaft = TURN.shaft_rad
    assert np.max(np.abs(each.error(TURN) - 0.25 * k * np.sin(4.0 * shaft))) < 0.25 * k * 4.0 * k


def test_shares_of_saturation_add_up_to_the_leading_term() -> None:
    field = np.array([[10.0], [0.0]])
    lost = [
        float(field[0, 0] - vertical_mT(field, Disk(gain=2.0, saturation_mT=400.0, per_axis=s))[0, 0] / 2.0)
        for s in (0.0, 0.4, 1.0)
    ]
    np.testing.assert_allclose(lost, 10.0 * (10.0 / 400.0) ** 2 / 3.0, rtol=1e-3)


def test_a_gain_of_one_is_no_disk_and_its_saturation_is_refused() -> None:
    chain = described(disk=Disk(gain=1.0))
    assert chain.described == ()
    assert np.max(np.abs(chain.error(TURN))) < 1e-12
    content = {"schema": SCHEMA, "hardware": {"disk": {"gain": 1.0, "saturation_mT": 60.0}}}
    with pytest.raises(
        TwinError, match="saturation_mT is 60 mT at a gain of 1, which is no disk and does not saturate"
    ):
        from_dict(content)


# ---- in every run ---------------------------------------------------------------------------------------------------


def test_described_parts_are_seen_in_the_mirror() -> None:
    chain = described(disk=SHIFTED, plate=TYPICAL, plate_y=replace(TYPICAL, asymmetry=-0.04))
    chain = replace(chain.with_effect("gain_mismatch", ratio=1.02), sensor_sense=-1)
    assert np.max(np.abs(chain.error(TURN))) > 1e-4
    np.testing.assert_allclose(wrap(chain.mirrored().readings(TURN) - chain.readings(TURN)), 0.0, atol=1e-12)
    assert to_dict(chain.mirrored().mirrored()) == to_dict(chain)


def test_described_parts_are_written_and_read() -> None:
    chain = described(field_mT=70.0, disk=SHIFTED, plate=TYPICAL, plate_y=Plate(offset_uV=1.0))
    assert from_dict(to_dict(chain)).parts == chain.parts
    assert from_dict(to_dict(chain.mirrored())).parts == chain.mirrored().parts


def test_no_message_offers_the_mirror() -> None:
    with pytest.raises(TwinError, match=r"hardware has no 'foo'; it has field_mT, disk, plate, plate_y, converter$"):
        from_dict({"schema": SCHEMA, "hardware": {"foo": 1}})


def test_a_stray_field_counts_in_the_magnet_whichever_is_set_first() -> None:
    magnet = Assembly(Magnet(), Placement(air_gap_mm=4.0))
    first = Chain().with_effect("stray_field", bx_mT=1.0).with_magnet(magnet)
    last = Chain().with_magnet(magnet).with_effect("stray_field", bx_mT=1.0)
    np.testing.assert_array_equal(first.readings(TURN), last.readings(TURN))
    given = Chain().with_effect("stray_field", bx_mT=1.0, field_mT=50.0).with_magnet(magnet)
    assert np.max(np.abs(given.readings(TURN) - first.readings(TURN))) > 1e-3


def test_offsets_that_cancel_are_no_ideal_plate() -> None:
    plate = Plate(offset_uV=1000.0, amplifier_offset_uV=-1000.0, asymmetry=0.1, spun=False)
    assert not plate.ideal
    assert Parts(plate=plate).plates[0].spun is False


def test_a_long_record_of_noisy_plates_is_computed_stretch_by_stretch(monkeypatch: pytest.MonkeyPatch) -> None:
    chain, whole = described(disk=Disk(), plate=TYPICAL), len(TURN)
    sizes: list[int] = []

    def told(field_mT: Array, *args: Any, **more: Any) -> Spinning:
        sizes.append(field_mT.size)
        return spin(field_mT, *args, **more)

    monkeypatch.setattr(plates, "spin", told)
    together = chain.channels(TURN, np.random.default_rng(1))
    assert sizes == [whole, whole]
    sizes.clear()
    monkeypatch.setattr(plates, "STRETCH", 4 * TYPICAL.samples * 100)
    apart = chain.channels(TURN, np.random.default_rng(1))
    assert max(sizes) == 100
    assert sum(sizes) == 2 * whole
    # The same plates, other noise: that of a reading is independent of its neighbours'.
    steady = chain.channels(TURN)
    assert np.std(apart - steady) == pytest.approx(np.std(together - steady), rel=5.0 / np.sqrt(4 * whole))


def test_a_plate_without_a_disk_sees_the_field_as_it_is() -> None:
    alone, beside = described(plate=TYPICAL), described(disk=Disk(gain=1.0), plate=TYPICAL)
    np.testing.assert_array_equal(alone.channels(TURN), beside.channels(TURN))


def test_refuses_a_plate_of_y_alone() -> None:
    with pytest.raises(OutOfRangeError, match="plate_y is described and plate is not"):
        Parts(plate_y=TYPICAL)


def test_the_noise_of_a_plate_spreads_the_readings() -> None:
    chain = described(disk=Disk(), plate=TYPICAL)
    first, again = (chain.simulate(TURN, seed=1).columns["measured_deg"] for _ in range(2))
    assert first.tobytes() == again.tobytes()
    # 20 nV per root Hz, half of each phase held: a band of 1 / (2 x 4 x 2.5 us), 6 x 50 mT x 100 uV/mT.
    rms_deg = np.degrees(20e-3 * np.sqrt(0.5 / 10e-6) / (6.0 * 50.0 * 100.0))
    found = np.std(wrap(np.radians(first) - chain.readings(TURN)))
    assert np.degrees(found) == pytest.approx(rms_deg, rel=0.1)
