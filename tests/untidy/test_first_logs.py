"""Logs as people first bring them: units in comments, labels before the numbers, a scope's head, one encoder twice."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from twin.angles import Array
from twin.errors import SweepError
from twin.logs.read import Log, read_log

ROWS = 360
SHAFT_DEG = np.arange(ROWS) * 2.0
READING_DEG = (SHAFT_DEG + 37.0 + 0.8 * np.sin(np.radians(SHAFT_DEG))) % 360.0
COUNTS = np.round(SHAFT_DEG * 4000.0 / 360.0) % 4000.0
TIME_MS = 4.0 * np.arange(ROWS)


def read(path: Path, text: str) -> Log:
    path.write_text(text)
    return read_log(path)


def csv(columns: Mapping[str, Array], *, above: Sequence[str] = ()) -> str:
    rows = np.column_stack(list(columns.values()))
    return "\n".join([*above, ",".join(columns), *(",".join(f"{cell:.10g}" for cell in row) for row in rows)]) + "\n"


def check(found: Log) -> None:
    """The reading is the sensor's, and its error that of order 1 alone."""
    away = np.radians(found.columns["measured_deg"] - found.columns["reference_deg"])
    error = np.degrees(np.angle(np.exp(1j * away) / np.mean(np.exp(1j * away))))
    assert np.ptp(error) == pytest.approx(1.6, abs=0.3)


@pytest.mark.parametrize("remark", ["angles in rad; time in ms", "t: ms, ref (rad), meas (rad)", "t [ms] ref = rad"])
def test_a_unit_may_stand_in_a_comment_alone(remark: str, tmp_path: Path) -> None:
    angles = {"ref": np.radians(SHAFT_DEG % 360.0), "meas": np.radians(READING_DEG)}
    found = read(tmp_path / "log.csv", csv({"t": TIME_MS, **angles}, above=[f"# {remark}"]))
    check(found)
    assert found.guess.text == "time_s=t:ms, reference_deg=ref:rad, measured_deg=meas:rad"


def test_a_comment_names_one_side_or_the_column() -> None:
    from twin.logs.remarks import units_remarked

    names = ["encoder", "sensor", "t", "temp [K]"]
    assert units_remarked(names, ["columns: encoder (counts of 4000), sensor (deg)"]) == {0: "counts", 1: "deg"}
    assert units_remarked(names, ["t in ms", "temp in C"]) == {2: "ms"}
    # Two units of a column are none.
    assert units_remarked(names, ["t in ms", "t in us"]) == {}
    assert units_remarked(names, ["time in rad", "temp in ms"]) == {}


@pytest.mark.parametrize(
    "form", ["ref: {0:.3f} angle: {1:.3f}", "ref:{0:.3f},angle:{1:.3f}", '{{"ref": {0}, "angle": {1}}}']
)
def test_a_label_may_stand_before_each_number(form: str, tmp_path: Path) -> None:
    lines = [form.format(a, b) for a, b in zip(SHAFT_DEG % 360.0, READING_DEG, strict=True)]
    # The last line is cut, as where a recording ends.
    found = read(tmp_path / "serial.txt", "\n".join([*lines, lines[0][:9]]))
    check(found)
    assert found.guess.text == "reference_deg=ref, measured_deg=angle"


def test_labels_that_differ_are_no_table(tmp_path: Path) -> None:
    lines = [f"ref: {a:.3f} angle: {a:.3f}" for a in SHAFT_DEG]
    lines[7] = "ref: 3.0 temperature: 21.0"
    with pytest.raises(SweepError):
        read(tmp_path / "serial.txt", "\n".join(lines))


def test_a_scopes_names_may_be_numbers_above_their_units(tmp_path: Path) -> None:
    at = np.radians(READING_DEG)
    rows = np.column_stack([0.004 * np.arange(ROWS), SHAFT_DEG % 360.0, np.degrees(at)])
    head = 'Model,DSO\nRate,250 Hz\n"x-axis","1","2"\nsecond,deg,deg\n'
    body = "\n".join(",".join(f"{cell:+.6E}" for cell in row) for row in rows)
    path = tmp_path / "scope.csv"
    path.write_text(head + body)
    found = read_log(path, columns="reference_deg='1 [deg]', measured_deg='2 [deg]'")
    assert found.columns["reference_deg"].size == ROWS
    check(found)


@pytest.mark.parametrize("called", ["raw", "angle_raw"])
def test_raw_may_be_parts_of_a_turn(called: str, tmp_path: Path) -> None:
    found = read(tmp_path / "log.csv", csv({"enc_counts": COUNTS, called: READING_DEG / 360.0}))
    check(found)
    assert f"measured_deg={called}:rev" in found.guess.text


def test_an_encoder_that_stands_twice_is_one(tmp_path: Path) -> None:
    """Over its turns and within one: neither is the other's reference, and either does."""
    over = np.round(SHAFT_DEG * 4000.0 / 360.0)
    found = read(tmp_path / "log.csv", csv({"encoder_count": over, "enc_counts": COUNTS, "sensor_deg": READING_DEG}))
    check(found)
    assert "reference_deg=encoder_count*360/4000, measured_deg=sensor_deg" in found.guess.text


def test_where_no_other_angle_is_there_a_copy_is_read(tmp_path: Path) -> None:
    """A sensor without any error, as a simulation has it."""
    found = read(tmp_path / "log.csv", csv({"ref_deg": SHAFT_DEG, "sensor_deg": SHAFT_DEG % 360.0}))
    assert found.guess.text == "reference_deg=ref_deg, measured_deg=sensor_deg"


def test_what_is_called_sens_and_takes_many_values_is_no_direction(tmp_path: Path) -> None:
    """Short for sensor; in French it is the direction."""
    found = read(tmp_path / "log.csv", csv({"enc": COUNTS, "sens": READING_DEG}))
    check(found)
