"""Logs of a sensor alone: one guess of columns and units, and the same in every command's words."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from diagnosis import diagnose, explain
from tests.command_line import halltwin
from tests.untidy.generator import Array, counts, table
from twin.errors import SweepError
from twin.logs.asked_back import OpenGuess
from twin.logs.read import read_log
from twin.logs.turn_seen import turns_seen
from twin.recording_file import read_recording

OPTION = re.compile(r'--columns "([^"]*)"')
TIME_S = np.arange(0.0, 2.0, 0.001)
FULL = "\"time_s='t [ms]':ms, measured_deg='angle [counts]'*360/16384\""


def shaft_deg(turns_per_s: float = 20.0, slower: float = 0.8) -> Array:
    """A shaft that coasts, with a sensor's error of order 2."""
    angle = 360.0 * turns_per_s * (1.0 - np.exp(-slower * TIME_S)) / slower
    return angle + 0.3 * np.sin(np.radians(2.0 * angle + 40.0)) + 123.0


def coast(folder: Path, a_turn: int = 16384, **other: Array) -> Path:
    """A log under names of its own."""
    path = folder / "coast.csv"
    path.write_text(table({"t [ms]": 1e3 * TIME_S, "angle [counts]": counts(shaft_deg(), a_turn), **other}, sep=";"))
    return path


@pytest.mark.parametrize("a_turn", [1000, 1024, 4000, 4096, 10_000, 16_000, 16_384, 65_536, 1_000_000, 1_048_576])
@pytest.mark.parametrize("words", [(), (65_535.0,), (-1.0,)])
def test_counts_a_turn_are_those_with_which_they_begin_anew(
    a_turn: int, words: tuple[float, ...], tmp_path: Path
) -> None:
    """Also where some transfers fail, which leaves a word of the link's instead."""
    angle = counts(shaft_deg(), a_turn)
    angle[[300, 900, 901]] = words or angle[[300, 900, 901]]
    path = tmp_path / "log.csv"
    path.write_text(table({"t_us": 1e6 * TIME_S, "encoder": angle}))
    assert read_log(path).guess.text == f"time_s=t_us:us, measured_deg=encoder*360/{a_turn}"


@pytest.mark.parametrize(("unit", "turn"), [("", 360.0), (":rad", 2.0 * np.pi), (":rev", 1.0)])
def test_an_angle_without_a_unit_is_in_that_whose_turn_it_shows(unit: str, turn: float, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table({"time": TIME_S, "angle": shaft_deg() % 360.0 * turn / 360.0}))
    assert read_log(path).guess.text == f"time_s=time, measured_deg=angle{unit}"


def test_a_turn_that_was_not_gone_through_is_none(tmp_path: Path) -> None:
    """Rocking over less than a turn leaves the middle of the range empty, or begins nothing anew."""
    rocked = 16384.0 / 360.0 * (40.0 * np.sin(9.0 * TIME_S))
    assert turns_seen(np.round(rocked + 9000.0)) == []
    assert turns_seen(np.round(rocked) % 16384.0) == []
    assert turns_seen(np.full(200, 7.0)) == []


def test_what_the_values_do_not_tell_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    rocked = np.round(9000.0 + 1800.0 * np.sin(9.0 * TIME_S))
    path.write_text(table({"t [ms]": 1e3 * TIME_S, "angle [counts]": rocked}))
    for command in ("import", "doctor"):
        ended = halltwin(command, path)
        assert ended.code == 2
        assert "goes from 7200 to 10800 and never begins anew" in ended.err
        assert "'angle [counts]'*360/COUNTS\"" in ended.err
    path.write_text(table({"time": 1000.0 * np.arange(2000.0), "angle": shaft_deg() % 360.0}))
    with pytest.raises(OpenGuess) as caught:
        read_log(path)
    assert caught.value.options[0] == "time_s=time:us, measured_deg=angle"


@pytest.mark.parametrize(
    ("name", "values", "option"),
    [
        ("angle [deg]", counts(shaft_deg(), 16384), "measured_deg='angle [deg]'*360/16384"),
        ("angle [rad]", shaft_deg() % 360.0, "measured_deg='angle [rad]'"),
        ("angle [V]", shaft_deg() % 360.0 / 360.0 * 4.7, "measured_deg='angle [V]'*360/4.697"),
    ],
)
def test_a_name_that_the_values_go_against_is_asked_about(
    name: str, values: Array, option: str, tmp_path: Path
) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table({"t [s]": TIME_S, name: values}))
    with pytest.raises(OpenGuess) as caught:
        read_log(path)
    assert caught.value.options == (f"time_s='t [s]', {option}",)


@pytest.mark.parametrize("command", ["explain", "compensate", "export"])
def test_a_command_that_takes_such_a_log_says_by_which_columns(command: str, tmp_path: Path) -> None:
    ended = halltwin(command, coast(tmp_path), *(("--for", "lut") if command == "export" else ()))
    assert ended.code == 0
    assert f"coast.csv: read as --columns {FULL}" in ended.err


@pytest.mark.parametrize("command", ["diagnose", "monitor"])
def test_a_command_that_needs_a_reference_says_which_does_not(command: str, tmp_path: Path) -> None:
    for options in ((), ("--columns", FULL.strip('"'))):
        ended = halltwin(command, coast(tmp_path), *options)
        assert ended.code == 2
        assert "explain, compensate and export take" in ended.err
        assert bool(options) or FULL in ended.err


def test_the_guess_is_one(tmp_path: Path) -> None:
    """What import, doctor, and the words of a refusal print is the same, and reads the log."""
    path = coast(tmp_path)
    told = [halltwin("import", path).err, halltwin("explain", path).err]
    assert {OPTION.findall(one)[0] for one in told} == {FULL.strip('"')}
    halltwin("import", path, "-o", tmp_path / "sweep.csv")
    imported, read = read_recording(tmp_path / "sweep.csv"), read_recording(path, columns=FULL.strip('"'))
    np.testing.assert_allclose(imported.measured_deg, read.measured_deg, atol=1e-6)
    np.testing.assert_allclose(imported.time_s, TIME_S, atol=1e-6)


@pytest.mark.parametrize("beside", ["reference", "encoder_deg", "position"])
def test_a_log_of_two_angles_is_never_one_of_a_sensor_alone(beside: str, tmp_path: Path) -> None:
    """A reference that the sensor does not follow, as with a magnet that is missing, is one all the same."""
    other = 360.0 * np.random.default_rng(3).random(TIME_S.size)
    path = coast(tmp_path, **{beside: other})
    with pytest.raises(SweepError):
        read_log(path)


def test_the_column_that_is_missing_is_the_time(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table({"measured_deg": shaft_deg() % 360.0}))
    assert "column time_s is missing" in halltwin("explain", path).err
    assert "time_s is missing" in halltwin("explain", coast(tmp_path), "--columns", "measured_deg=#2").err
    assert "index/1000" in halltwin("explain", path).err
    rows = TIME_S.size / (TIME_S[-1] - TIME_S[0])
    counted = read_recording(path, columns=f"time_s=index/{rows:.9g}, measured_deg=measured_deg")
    np.testing.assert_allclose(counted.time_s, np.arange(TIME_S.size) / rows)
    path.write_text(table({"measured_deg": shaft_deg() % 360.0, "index": 3.0 * TIME_S}))
    own = read_recording(path, columns="time_s=index, measured_deg=measured_deg")
    np.testing.assert_allclose(own.time_s, 3.0 * TIME_S, rtol=1e-6)
    with pytest.raises(SweepError, match="column time_s is missing"):
        explain({"measured_deg": shaft_deg() % 360.0})


def test_python_takes_the_same_columns(tmp_path: Path) -> None:
    statement = FULL.strip('"')
    with pytest.raises(SweepError, match=re.escape(statement)):
        explain(str(coast(tmp_path)))
    with pytest.raises(SweepError, match="columns says how a file is read"):
        explain({"measured_deg": shaft_deg(), "time_s": TIME_S}, columns=statement)
    found = explain(str(coast(tmp_path)), columns=statement)
    assert found.sweep.estimated is not None


def test_python_takes_the_columns_of_a_sweep_too(tmp_path: Path) -> None:
    shaft = 2.5 * np.arange(360.0)
    path = tmp_path / "log.csv"
    path.write_text(table({"ref": shaft, "sensor": (shaft + 3.0 + 0.5 * np.sin(np.radians(shaft))) % 360.0}))
    found = diagnose(str(path), columns="reference_deg=ref, measured_deg=sensor")
    assert found.factors["gain_ratio"].value == pytest.approx(1.0, abs=0.01)
