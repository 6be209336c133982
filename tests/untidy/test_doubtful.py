"""Two columns that follow each other and are hardly a reference and a sensor: asked about, never taken."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from tests.untidy.generator import MEASURED_DEG, REFERENCE_DEG, ROWS, counts, table
from twin.errors import SweepError
from twin.logs.asked_back import OpenGuess
from twin.logs.read import read_log

EVEN_DEG = np.arange(500) * 360.0 / 500.0
ANGLE_DEG = (EVEN_DEG + 41.0 + 0.8 * np.sin(np.radians(EVEN_DEG + 20.0))) % 360.0
RAW = counts(MEASURED_DEG, 4096)
TURNED_DEG = np.degrees(np.unwrap(np.radians(MEASURED_DEG)))


def written(folder: Path, columns: dict[str, np.ndarray]) -> Path:
    path = folder / "log.csv"
    path.write_text(table(columns))
    return path


@pytest.mark.parametrize("name", ["seq", "count", "tick", "line", "point", "Reading", "i", "sample_no"])
def test_a_counter_of_rows_is_asked_about(name: str, tmp_path: Path) -> None:
    """As many counts a turn as there are rows in it would fit each of them."""
    with pytest.raises(OpenGuess, match="goes on by 1 in each row") as asked:
        read_log(written(tmp_path, {name: np.arange(500.0), "angle_deg": ANGLE_DEG}))
    assert f"reference_deg={name}*360/500, measured_deg=angle_deg" in asked.value.options
    assert read_log(tmp_path / "log.csv", columns=asked.value.options[0]).columns["measured_deg"].size == 500


def test_an_even_clock_without_a_name_is_asked_about(tmp_path: Path) -> None:
    with pytest.raises(OpenGuess, match="goes on by 10 in each row"):
        read_log(written(tmp_path, {"stamp": 10.0 * np.arange(500), "angle_deg": ANGLE_DEG}))


def test_steps_of_a_motor_and_even_degrees_are_a_reference(tmp_path: Path) -> None:
    """Names or values say that they are an angle."""
    steps = written(
        tmp_path, {"step": np.arange(200.0), "angle": ANGLE_DEG[:200] - EVEN_DEG[:200] + 1.8 * np.arange(200)}
    )
    assert read_log(steps).guess.text == "reference_deg=step*360/200, measured_deg=angle"
    even = 10.0 * np.arange(36)
    degrees = written(tmp_path, {"soll": even, "": even + np.sin(np.radians(even))})
    assert read_log(degrees).guess.text == "reference_deg=soll, measured_deg=#2"


def test_a_counter_beside_a_time_leaves_the_sensor_alone(tmp_path: Path) -> None:
    columns = {"tick": np.arange(500.0), "time_ms": 2.0 * np.arange(500), "angle_deg": ANGLE_DEG}
    assert read_log(written(tmp_path, columns)).guess.text == "time_s=time_ms:ms, measured_deg=angle_deg"


@pytest.mark.parametrize(
    "columns",
    [
        {"raw_counts": RAW, "angle_deg": np.round(RAW * 360.0 / 4096.0, 2)},
        {"raw_counts": RAW, "angle_deg": np.round((RAW * 360.0 / 4096.0 - 30.0) % 360.0, 1)},
        {"raw_counts": RAW, "angle_deg": np.round((30.0 - RAW * 360.0 / 4096.0) % 360.0, 1)},
        {"raw_counts": RAW, "angle": np.floor(MEASURED_DEG * 1024.0 / 360.0)},
        {"angle_deg": MEASURED_DEG, "cumulative_deg": TURNED_DEG},
        {"angle_deg": MEASURED_DEG, "angle_rad": np.radians(MEASURED_DEG)},
    ],
    ids=["two digits", "another zero", "the other way", "fewer bits", "over turns", "radians"],
)
def test_one_sensor_that_stands_twice_is_asked_about(columns: dict[str, np.ndarray], tmp_path: Path) -> None:
    with pytest.raises(OpenGuess, match="one angle to the last digit"):
        read_log(written(tmp_path, columns))


def test_one_sensor_twice_beside_a_time_may_be_a_log_without_a_reference(tmp_path: Path) -> None:
    columns = {"time_ms": 2.0 * np.arange(ROWS), "raw_counts": RAW, "angle_deg": np.round(RAW * 360.0 / 4096.0, 2)}
    with pytest.raises(OpenGuess) as asked:
        read_log(written(tmp_path, columns))
    assert asked.value.options[-1] == "time_s=time_ms:ms, measured_deg=angle_deg"


def test_an_error_within_the_last_digit_of_named_columns_is_a_sensors(tmp_path: Path) -> None:
    """A good sensor against coarse counts of an encoder: names tell which is which."""
    off = 0.05 * np.sin(np.radians(REFERENCE_DEG))
    columns = {"encoder_counts": counts(REFERENCE_DEG, 1024), "angle_deg": (REFERENCE_DEG + off) % 360.0}
    assert re.fullmatch(r"reference_deg=encoder_counts\*360/1024, .*", read_log(written(tmp_path, columns)).guess.text)


def test_a_short_span_beside_degrees_is_in_degrees(tmp_path: Path) -> None:
    near = np.linspace(10.0, 13.0, 40)
    columns = {"encoder_deg": near, "hall": near + 40.0 + 0.1 * np.sin(near)}
    assert read_log(written(tmp_path, columns)).guess.text == "reference_deg=encoder_deg, measured_deg=hall"


def test_a_counter_with_lost_rows_and_a_clock_that_jitters_are_asked_about(tmp_path: Path) -> None:
    """No name of theirs is that of a reference."""
    rows = np.delete(np.arange(100.0), 50)
    shaft = 3.6 * rows
    beats = 10.0 * rows + np.random.default_rng(1).integers(-1, 2, rows.size)
    for columns in ({"tick": rows}, {"stamp": beats}, {"rolling": (2.56 * shaft / 3.6) // 1.0 % 256.0}):
        with pytest.raises(OpenGuess):
            read_log(written(tmp_path, {**columns, "angle_deg": shaft + np.sin(np.radians(shaft))}))


def test_one_sensor_before_and_behind_its_filter_is_asked_about(tmp_path: Path) -> None:
    raw = counts(TURNED_DEG, 4096)
    slow = np.convolve(np.concatenate([np.full(4, TURNED_DEG[0]), TURNED_DEG]), np.full(5, 0.2), "valid")
    with pytest.raises(OpenGuess, match="neither name is that of a reference"):
        read_log(written(tmp_path, {"raw_counts": raw, "angle_deg": slow % 360.0}))


def test_an_electrical_angle_made_of_the_shafts_is_asked_about(tmp_path: Path) -> None:
    """As a driver for motors logs both: they differ by their last digits, as no two sensors do."""
    at = np.radians(TURNED_DEG)
    columns = {"shaft_angle": np.round(at, 5), "electrical_angle": np.round(np.mod(7.0 * at, 2.0 * np.pi), 5)}
    with pytest.raises(OpenGuess, match="7 times a turn, as those of one sensor"):
        read_log(written(tmp_path, columns))
    own = at + 0.01 * np.sin(at)
    columns["electrical_angle"] = np.round(np.mod(7.0 * own, 2.0 * np.pi), 5)
    assert "unwrap(electrical_angle:rad)/7" in read_log(written(tmp_path, columns)).guess.text


def test_a_few_degrees_and_most_of_a_turn_in_radians_are_asked_about(tmp_path: Path) -> None:
    few = np.linspace(-2.0, 2.0, 40)
    with pytest.raises(OpenGuess) as asked:
        read_log(written(tmp_path, {"ref": few, "sensor": few + 0.02 * np.sin(3.0 * few)}))
    assert set(asked.value.options) == {
        "reference_deg=ref, measured_deg=sensor",
        "reference_deg=ref:rad, measured_deg=sensor:rad",
    }


@pytest.mark.parametrize("name", ["travel_mm", "coil_mA", "pos_um"])
def test_what_has_another_unit_is_no_angle(name: str, tmp_path: Path) -> None:
    """A belt's travel may go on as the angle does; no statement makes an angle of millimetres."""
    columns = {name: REFERENCE_DEG, "sensor_deg": MEASURED_DEG}
    with pytest.raises(SweepError, match="no two columns are angles"):
        read_log(written(tmp_path, columns))


def test_a_capital_t_is_no_time_beside_one_that_has_a_unit(tmp_path: Path) -> None:
    warm = 24.0 + 0.003 * np.arange(ROWS)
    columns = {"T": warm, "t_ms": 20.0 * np.arange(ROWS), "ref_deg": REFERENCE_DEG, "sensor_deg": MEASURED_DEG}
    assert read_log(written(tmp_path, columns)).guess.text.startswith("time_s=t_ms:ms, ")
    del columns["t_ms"]
    assert "time_s" not in read_log(written(tmp_path, columns)).columns


@pytest.mark.parametrize("names", [("desired_deg", "actual_deg"), ("wanted_deg", "encoder_deg")])
def test_what_was_asked_for_and_what_came_are_not_swapped(names: tuple[str, str], tmp_path: Path) -> None:
    with pytest.raises(OpenGuess) as asked:
        read_log(written(tmp_path, dict(zip(names, (REFERENCE_DEG, MEASURED_DEG), strict=True))))
    assert f"reference_deg={names[0]}, measured_deg={names[1]}" in asked.value.options


def test_an_encoder_under_test_is_the_sensor_beside_a_goniometer(tmp_path: Path) -> None:
    columns = {"encoder_deg": MEASURED_DEG, "goniometer_deg": REFERENCE_DEG}
    assert read_log(written(tmp_path, columns)).guess.text == "reference_deg=goniometer_deg, measured_deg=encoder_deg"


def test_the_unit_of_an_error_that_has_none_is_told_as_taken_for_granted(tmp_path: Path) -> None:
    at = np.arange(0.0, 360.0, 15.0)
    found = read_log(written(tmp_path, {"ref": at, "error": 3.0 * np.sin(np.radians(at))}))
    assert any("without a unit" in note for note in found.guess.notes)
