"""The checks of the set-up on records where two of them could be taken for each other."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.setup.checks import checked
from diagnosis.setup.record import Record
from twin.angles import Array
from twin.following import swing_deg

TURN_DEG = np.arange(0.0, 1080.0, 4.0)


def kinds(**columns: Array) -> list[str]:
    n = next(iter(columns.values())).size
    return [one.kind for one in checked(Record("record", columns, np.arange(1, n + 1))).findings]


def reading(shaft: Array = TURN_DEG, *, seed: int = 1, noise_deg: float = 0.03) -> Array:
    """A sensor of small errors."""
    noise = noise_deg * np.random.default_rng(seed).standard_normal(shaft.size)
    return (shaft + 20.0 + 0.8 * np.sin(np.radians(shaft)) + 0.3 * np.cos(np.radians(2.0 * shaft)) + noise) % 360.0


def test_nothing_is_found_in_a_sensor_of_small_errors() -> None:
    assert kinds(reference_deg=TURN_DEG, measured_deg=reading(), time_s=0.001 * TURN_DEG) == []


def test_a_top_bit_that_is_stuck_is_no_axial_magnet() -> None:
    """The reading stays in half a turn, but falls back at once."""
    stuck = 180.0 + reading() % 180.0
    assert "axial_magnet" not in kinds(reference_deg=TURN_DEG, measured_deg=stuck)


def test_an_axial_magnet_is_told_with_the_turns_of_the_reference() -> None:
    columns = {"reference_deg": TURN_DEG, "measured_deg": 200.0 + 18.0 * np.sin(np.radians(TURN_DEG))}
    (found,) = checked(Record("record", columns, np.arange(1, TURN_DEG.size + 1))).findings
    # 270 readings 4 deg apart end one step ahead of the third turn's end.
    assert found.evidence.endswith("while the reference goes round 2.99 times")


def test_a_reading_that_falls_back_at_once_does_not_swing() -> None:
    """In radians a turn spans 6.28, and its low orders go to and fro."""
    assert swing_deg(np.radians(reading()), TURN_DEG) is None
    assert swing_deg(3.0 + 3.0 * np.sin(np.radians(TURN_DEG)), TURN_DEG) == pytest.approx((0.0, 6.0), abs=0.05)


def test_a_stretch_that_is_off_is_no_open_turn() -> None:
    """Twelve rows are 6 deg off, and all is well behind them."""
    own = reading()
    own[100:112] += 6.0
    assert "turn_not_closed" not in kinds(reference_deg=TURN_DEG, measured_deg=own)


def test_a_slip_is_no_wrong_number_of_counts() -> None:
    """Two slips of 3 deg in three turns open them by as much as a wrong number would."""
    row = np.arange(TURN_DEG.size)
    slipped = TURN_DEG + 3.0 * (row >= 70) + 3.0 * (row >= 200)
    assert kinds(reference_deg=slipped, measured_deg=reading()) == ["turn_not_closed"]


def test_every_slip_is_told_with_its_row_and_the_rows_of_no_other() -> None:
    row = np.arange(TURN_DEG.size)
    slipped = TURN_DEG - 3.0 * (row >= 70) + 2.0 * (row >= 200)
    (found,) = checked(Record("r", {"reference_deg": slipped, "measured_deg": reading()}, row + 1)).findings
    assert found.rows == (71, 201)
    assert found.evidence.startswith("the zero steps at row 71 by +3.0")


def test_a_wrong_number_of_counts_is_no_slip() -> None:
    assert kinds(reference_deg=TURN_DEG * 4096.0 / 4000.0, measured_deg=reading()) == ["wrong_counts"]


def test_a_zero_that_steps_where_the_shaft_turns_round_is_no_open_turn() -> None:
    """Play or hysteresis of 0.8 deg, there and back."""
    shaft = np.concatenate([TURN_DEG, TURN_DEG[::-1]])
    behind = np.repeat([0.4, -0.4], TURN_DEG.size)
    assert kinds(reference_deg=shaft, measured_deg=reading(shaft - behind)) == []


def test_a_table_on_the_sensors_axis_is_no_swap() -> None:
    """64 even readings of one turn, whose angles are not even: as a firmware keeps its correction."""
    index = np.arange(64) * 360.0 / 64.0
    assert kinds(reference_deg=index - 0.8 * np.sin(np.radians(index)), measured_deg=index) == []


def test_even_readings_of_several_turns_are_a_swap() -> None:
    assert "swapped_roles" in kinds(reference_deg=np.unwrap(reading(), period=360.0), measured_deg=TURN_DEG % 360.0)


def test_a_sensor_that_counts_against_its_channels_has_not_swapped_them() -> None:
    own = reading()
    at = np.radians(own)
    columns = {"reference_deg": TURN_DEG, "measured_deg": own}
    assert kinds(**columns, vx=1000.0 * np.cos(-at), vy=1000.0 * np.sin(-at)) == []
    assert kinds(**columns, vx=1000.0 * np.sin(at), vy=1000.0 * np.cos(at)) == ["swapped_channels"]


def test_channels_without_a_signal_are_told() -> None:
    """explain refuses them: the set-up is not well."""
    at = np.radians(reading())
    columns = {"reference_deg": TURN_DEG, "measured_deg": reading()}
    assert kinds(**columns, vx=1e-300 * np.cos(at), vy=1e-300 * np.sin(at)) == ["weak_field"]
    assert kinds(**columns, vx=1e-9 * np.cos(at), vy=1e-9 * np.sin(at)) == []


def test_stamps_of_stops_may_be_coarse() -> None:
    """Of a shaft that stands still at each reading nothing goes with the time; of one that turns it does."""
    whole_s = np.floor(0.4 * np.arange(TURN_DEG.size))
    assert kinds(reference_deg=TURN_DEG, measured_deg=reading(), time_s=whole_s) == []
    assert kinds(reference_deg=TURN_DEG, measured_deg=reading(), time_s=0.004 * whole_s) == ["time_coarse"]


def test_angles_that_come_again_clip_no_channel() -> None:
    """Without noise each turn has the very same largest value."""
    at = np.radians(TURN_DEG)
    assert kinds(reference_deg=TURN_DEG, measured_deg=TURN_DEG % 360.0, vx=np.cos(at), vy=np.sin(at)) == []


def test_a_wild_reading_or_two_are_no_weak_magnet() -> None:
    own = reading()
    own[[20, 90, 150, 200]] = 0.0
    assert "weak_field" not in kinds(reference_deg=TURN_DEG, measured_deg=own)
    assert kinds(reference_deg=TURN_DEG, measured_deg=reading(noise_deg=3.0)) == ["weak_field"]


@pytest.mark.parametrize(("order", "found"), [(30, ["aliased_order"]), (12, [])])
def test_an_alias_is_thought_of_where_there_is_one_near(order: int, found: list[str]) -> None:
    """Of 90 points a turn order 30 may be 60 or 120, both within what teeth and slots make; 12 is clipping's."""
    line = 0.3 * np.sin(np.radians(order * TURN_DEG))
    assert kinds(reference_deg=TURN_DEG, measured_deg=reading() + line) == found


def test_the_other_way_round_is_a_note() -> None:
    record = Record("r", {"reference_deg": -TURN_DEG, "measured_deg": reading()}, np.arange(1, TURN_DEG.size + 1))
    (found,) = checked(record).findings
    assert (found.kind, found.level) == ("other_way", "note")
    assert found.columns == "reference_deg=reference_deg*-1, measured_deg=measured_deg"


def test_what_could_not_be_checked_is_told_with_what_it_lacks() -> None:
    record = Record("r", {"reference_deg": TURN_DEG, "measured_deg": reading()}, np.arange(1, TURN_DEG.size + 1))
    assert checked(record).not_checked["lost_frames"] == ("frame",)
    assert checked(record).not_checked["time_unit"] == ("time_s",)


def test_rows_that_were_rejected_are_no_lost_frames() -> None:
    kept = np.setdiff1d(np.arange(TURN_DEG.size), [10, 11, 70])
    columns = {"reference_deg": TURN_DEG[kept], "measured_deg": reading()[kept], "frame": kept % 256.0}
    assert checked(Record("r", columns, kept + 1)).findings == ()
    found = checked(Record("r", columns, np.arange(1, kept.size + 1))).findings
    assert [one.kind for one in found] == ["lost_frames"]


def test_a_late_reading_is_told_from_play_by_its_speeds() -> None:
    """1.5 ms of a sensor at 100 to 300 rpm are 0.9 to 2.7 deg; at one speed they are a part of the zero."""
    speed = 100.0 + 200.0 * np.sin(np.linspace(0.0, np.pi, TURN_DEG.size))
    late = (reading() - 6.0 * 1.5e-3 * speed) % 360.0
    record = Record(
        "r",
        {"reference_deg": TURN_DEG, "measured_deg": late, "speed_rpm": speed},
        np.arange(1, TURN_DEG.size + 1),
    )
    found = [one for one in checked(record).findings if one.kind == "read_late"]
    assert [one.what for one in found] == ["the sensor is read later than the other"]
    assert "1.5 ms" in found[0].evidence
    steady = (reading() - 6.0 * 1.5e-3 * 200.0) % 360.0
    assert kinds(reference_deg=TURN_DEG, measured_deg=steady, speed_rpm=0.0 * TURN_DEG + 200.0) == []


def test_no_record_ends_in_a_fault_of_the_program() -> None:
    """Columns of anything, of any length, in any company."""
    rng = np.random.default_rng(8)
    names = ("reference_deg", "measured_deg", "time_s", "speed_rpm", "turn", "vx", "vy", "agc", "magnitude", "status")
    for _ in range(300):
        n = int(rng.choice([0, 1, 3, 8, 16, 60, 200]))
        kinds_of_column = (
            np.zeros(n),
            np.full(n, np.nan),
            1e12 * rng.standard_normal(n),
            np.round(rng.uniform(0.0, 5.0, n)),
            np.where(rng.random(n) < 0.3, np.nan, rng.uniform(0.0, 360.0, n)),
            rng.uniform(-60.0, 60.0) * np.arange(n),
        )
        columns = {name: kinds_of_column[rng.integers(0, 6)] for name in (*names, "frame") if rng.random() < 0.8}
        found = checked(Record("record", columns, np.arange(1, n + 1)))
        assert all(one.what and one.remedy for one in found.findings)
