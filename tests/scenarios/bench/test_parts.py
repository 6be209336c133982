"""The parts by themselves: messages, drive, loading, plan, options, display."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from diagnosis.correction.compensation import Correction
from scenarios.bench.buses import parse_options
from scenarios.bench.command import Options, run
from scenarios.bench.hall_node import check_playable, corrected_word, spi_frame
from scenarios.bench.hidden import hidden_encoder
from scenarios.bench.loading import ACTIVE, RECEIVING, REFUSED, Loader, items, numbers
from scenarios.bench.messages import checksum, messages, with_counter
from scenarios.bench.plan import Plan
from scenarios.bench.progress import curve
from scenarios.bench.stepper import Stepper
from scenarios.cli.app import app
from twin.angles import TAU
from twin.errors import UserError
from twin.link.frames import crc8, spi_words
from twin.sweep import Sweep


def a_correction() -> Correction:
    return Correction(-1, 0.25, np.array([[0.01, -0.002], [0.003, 0.0005]]), (), 0.0)


def test_every_message_is_documented_and_ends_in_a_checksum() -> None:
    for message in messages().by_name.values():
        assert message.comment
        assert message.signals[-1].name == "Checksum"
        assert message.length == 8
        assert ("Counter" in message.signal_tree) == (messages().sender(message.name) != "Bench")


def test_the_checksum_is_that_of_the_link_and_sees_every_single_bit() -> None:
    message = messages().encode(
        "HallAngle", {"Sequence": 7, "Angle": 90.0, "Bits": 14, "Corrected": 0, "SpiFault": 0}, 3
    )
    row = np.array([[0xA0, 0x01, *message.data[:7]]], dtype=np.uint8)
    assert checksum(message.arbitration_id, message.data) == crc8(row)[0]
    frame = messages().decode(message)
    assert frame is not None
    assert frame.sound
    assert (frame.values["Angle"], frame.counter) == (90.0, 3)
    for bit in range(64):
        message.data[bit // 8] ^= 1 << bit % 8
        spoiled = messages().decode(message)
        assert spoiled is not None
        assert not spoiled.sound
        message.data[bit // 8] ^= 1 << bit % 8
    held = messages().decode(with_counter(message, 11))
    assert held is not None
    assert held.sound
    assert held.counter == 11


@pytest.mark.parametrize("angle", [-123456.789, -0.001, 0.0, 359.999, 100000.123])
def test_targets_come_through_to_a_thousandth(angle: float) -> None:
    frame = messages().decode(
        messages().encode("MotionCommand", {"Sequence": 1, "Target": angle, "Speed": 59.5, "Passing": 1})
    )
    assert frame is not None
    assert frame.values["Target"] == pytest.approx(angle, abs=1e-9)
    assert frame.values["Speed"] == 59.5


def test_a_motion_takes_its_ramps() -> None:
    drive = Stepper(acceleration_rpm_per_s=600.0, settle_s=0.5)
    # 60 rpm is reached in 0.1 s over 18 deg; a turn at 60 rpm takes 1 s.
    assert drive.duration(TAU, 60.0) == pytest.approx(1.0 + 0.1 + 0.5)
    # Too short to reach the speed: half the way speeding up, half slowing down, at 3600 deg/s^2.
    assert drive.duration(np.radians(9.0), 60.0) == pytest.approx(2.0 * np.sqrt(9.0 / 3600.0) + 0.5)
    assert drive.commanded(np.radians(1.0)) == pytest.approx(np.radians(1.0), abs=np.pi / (200 * 256))
    stands = [drive.stands(a) - a for a in np.linspace(0.0, TAU, 1000)]
    assert np.degrees(np.max(np.abs(stands))) == pytest.approx(drive.error_deg, rel=1e-3)


def test_the_word_goes_over_spi_under_its_count() -> None:
    frames = [spi_frame(np.array([1.0]), 14, count) for count in range(18)]
    np.testing.assert_array_equal(spi_frame(np.ones(3), 14, 15), np.concatenate(frames[15:18]))
    for count, frame in enumerate(frames):
        words, sound, _ = spi_words(frame, 14)
        assert sound[0]
        assert words[0] == round(1.0 / TAU * 2**14)
        assert frame[0, 2] == count % 16


def test_a_correction_arrives_as_it_was_sent() -> None:
    loader, sent = Loader(), a_correction()
    listed = items(numbers(sent))
    states = [loader.take(5, item, value) for item, value in enumerate(listed)]
    assert states == [RECEIVING] * (len(listed) - 1) + [ACTIVE]
    assert loader.active is not None
    assert numbers(loader.active) == numbers(sent)
    assert loader.take(5, len(listed) - 1, 0.0) == ACTIVE
    word = corrected_word(loader.active, 0x4000)
    wanted = sent.shaft(np.array([TAU / 4]))[0] % TAU / TAU * 2**16
    assert word == round(wanted)
    assert [loader.take(5, item, value) for item, value in enumerate(items([]))] == [RECEIVING, ACTIVE]
    assert loader.active is None


@pytest.mark.parametrize("missing", [1, 2, 4])
def test_a_correction_with_a_gap_changes_nothing(missing: int) -> None:
    loader = Loader()
    for item, value in enumerate(items(numbers(a_correction()))):
        if item != missing:
            state = loader.take(1, item, value)
    assert state == REFUSED
    assert loader.active is None


def test_a_plan_goes_back_over_the_same_angles() -> None:
    plan = Plan(points=8, turns=2, both_directions=True, temperatures_c=(20.0, 60.0))
    stops = list(plan.stops())
    assert len(stops) == plan.readings == 64
    assert [stop.index for stop in stops] == list(range(64))
    assert [stop.angle_deg for stop in stops[:16]] == [stop.angle_deg for stop in stops[16:32]][::-1]
    assert {stop.turn for stop in stops} == set(range(8))
    assert {stop.temperature_c for stop in stops[:32]} == {20.0}


def test_a_plan_holds_every_reversal() -> None:
    plan = Plan(points=8, both_directions=True, speeds_rpm=(0.0, 60.0, 300.0))
    stops = list(plan.stops())
    assert len(stops) == plan.readings
    for one, other in itertools.pairwise(stops):
        travel = other.angle_deg - one.angle_deg
        assert travel == 0.0 or np.sign(travel) == other.direction
    for stop in stops:
        assert stop.speed_rpm == 0.0 or 0.0 <= stop.angle_deg < 360.0


def test_a_plan_in_one_direction_never_goes_back() -> None:
    stops = list(Plan(points=8, speeds_rpm=(0.0, 300.0, 60.0), temperatures_c=(20.0, 60.0)).stops())
    assert {stop.direction for stop in stops} == {1}
    assert np.all(np.diff([stop.angle_deg for stop in stops]) > 0.0)
    assert [stop.angle_deg % 360.0 for stop in stops[:8]] == [45.0 * k for k in range(8)]


@pytest.mark.parametrize(
    "wrong",
    [
        {"points": 4},
        {"turns": 0},
        {"speeds_rpm": (0.3,)},
        {"speeds_rpm": (5000.0,)},
        {"settle_s": -1.0},
        {"points": 3600, "turns": 100},
        {"temperatures_c": (900.0,)},
    ],
)
def test_plans_that_the_bus_cannot_carry_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(UserError):
        Plan(**wrong)  # type: ignore[arg-type]


def test_options_of_the_bus_become_numbers() -> None:
    assert parse_options(["bitrate=500000", "fd=false", "port=0x10", "f=1.5", "x=a"]) == {
        "bitrate": 500000,
        "fd": False,
        "port": 16,
        "f": 1.5,
        "x": "a",
    }
    with pytest.raises(UserError):
        parse_options(["bitrate"])


@pytest.mark.parametrize("text", ["nothing:x=1", "offset", "offset:z=1", "offset:x_percent=a", "offset:x_percent=1e9"])
def test_what_cannot_be_hidden_is_one_line(text: str) -> None:
    with pytest.raises(UserError, match="--hide"):
        hidden_encoder(None, [text])


# A tone is counted from the record's middle: read one by one, it would sound at half its frequency.
@pytest.mark.parametrize("text", ["zero_drift:amplitude_deg=1", "mains_pickup:x_percent=1"])
def test_effects_of_a_whole_record_are_not_for_the_bus(text: str) -> None:
    with pytest.raises(UserError, match=text.partition(":")[0]):
        check_playable(hidden_encoder(None, [text]))


def test_the_curve_has_its_dots_where_the_errors_are() -> None:
    drawn, edge = curve(np.array([0.0, 359.9]), np.array([0.5, -0.5]), width=4, height=2)
    top, bottom = drawn.split("\n")
    assert edge == 0.5
    assert (top[0], bottom[-1]) == ("\u2801", "\u2880")


def test_speeds_and_temperatures_are_recorded(tmp_path: Path) -> None:
    output = tmp_path / "sweep.csv"
    options = ["--points", "12", "--speed-rpm", "0", "--speed-rpm", "300", "--temperatures", "25,60"]
    result = CliRunner().invoke(app, ["bench", "-o", str(output), *options, "--hide", "latency:delay_us=500"])
    assert result.exit_code == 0
    sweep = Sweep.read(output)
    assert sweep.speed_rpm is not None
    assert sweep.temperature_c is not None
    assert sweep.time_s is not None
    # Twelve readings in each of four legs, and the stops before and behind those that are passed.
    assert len(sweep) == 52
    assert set(sweep.speed_rpm) == {0.0, 300.0}
    np.testing.assert_allclose(sorted(set(np.round(sweep.temperature_c))), [25.0, 60.0])
    moving = sweep.speed_rpm > 0.0
    late = np.mean((sweep.measured_deg - sweep.reference_deg + 180.0) % 360.0 - 180.0, where=moving)
    still = np.mean((sweep.measured_deg - sweep.reference_deg + 180.0) % 360.0 - 180.0, where=~moving)
    # 500 us at 300 rpm, 1800 deg/s.
    assert late - still == pytest.approx(-0.9, abs=0.05)
    between = np.diff(sweep.time_s)[moving[1:] & moving[:-1] & (np.diff(sweep.temperature_c) == 0)]
    np.testing.assert_allclose(between, 30.0 / 1800.0, atol=2e-5)


def test_a_bench_without_a_chamber_records_no_temperature(tmp_path: Path) -> None:
    output, log, again = (tmp_path / name for name in ("sweep.csv", "bus.asc", "again.csv"))
    run(Options(output=output, points=12, chamber=False, channels=False, record=log))
    assert list(Sweep.read(output).columns) == ["time_s", "reference_deg", "measured_deg", "direction", "turn"]
    run(Options(output=again, replay=log, chamber=False, channels=False))
    assert again.read_bytes() == output.read_bytes()
    with pytest.raises(UserError, match="needs the climate chamber"):
        run(Options(output=output, chamber=False, temperatures="25,60"))


def test_a_mistake_is_one_line_and_two(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["bench", "-o", str(tmp_path / "s.csv"), "--fault", "nonsense"])
    assert isinstance(result.exception, UserError)
    assert not list(tmp_path.iterdir())
