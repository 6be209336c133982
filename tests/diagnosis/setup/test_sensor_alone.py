"""The set-up of a log without a reference: its turn, the shaft's way, its clock, and what is said of them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis.setup.checks import checked
from diagnosis.setup.of_log import read_record
from tests.command_line import Array, csv_text, explained, halltwin
from twin.errors import SweepError
from twin.spin import Spin

TIME = np.arange(0.0, 3.0, 0.001)
TRAVEL = 2500.0 * (TIME - 0.08 * TIME**2) + 0.4 * np.sin(np.radians(2500.0 * TIME)) + 20.0
COUNTS = np.floor(TRAVEL * 16384.0 / 360.0) % 16384.0


def found_in(folder: Path, columns: dict[str, Array], said: str | None = None) -> dict[str, Any]:
    """What is found in a log, by its kind; without what no log of a sensor alone lacks."""
    path = folder / "log.csv"
    path.write_text(csv_text(columns))
    read = read_record(path, name="log.csv", columns=said)
    found = checked(read.record, read.findings)
    assert not {"units", "time_backwards", "time_jitter"} & set(found.not_checked)
    return {one.kind: one for one in found.findings if one.kind != "no_reference"}


def test_a_good_coast_has_no_fault(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(csv_text({"t [ms]": 1e3 * TIME, "angle [counts]": COUNTS}))
    ended = halltwin("doctor", path, "--fail-on", "fault", "--json", tmp_path / "found.json")
    assert ended.code == 0
    found = json.loads((tmp_path / "found.json").read_text())["setup"]
    assert [(one["kind"], one["level"]) for one in found] == [("no_reference", "note")]
    # A line to be copied: whole, in whichever terminal.
    assert """--columns "time_s='t [ms]':ms, measured_deg='angle [counts]'*360/16384"\n""" in ended.out


@pytest.mark.parametrize(
    ("said", "kind", "mended"),
    [
        ("angle*360/4096", "wrong_counts", "angle*360/16384"),
        ("angle*360/65536", "wrong_counts", "angle*360/16384"),
        ("angle", "units", "angle*360/16384"),
        ("angle:rad", "units", "angle*360/16384"),
        ("angle*360/16384", None, None),
    ],
)
def test_the_turn_is_the_one_with_which_the_readings_begin_anew(
    said: str, kind: str | None, mended: str | None, tmp_path: Path
) -> None:
    found = found_in(tmp_path, {"t": TIME, "angle": COUNTS}, f"time_s=t, measured_deg={said}")
    assert list(found) == ([] if kind is None else [kind])
    if kind is not None:
        assert found[kind].columns == f"time_s=t, measured_deg={mended}"


def test_degrees_under_radians_are_found(tmp_path: Path) -> None:
    found = found_in(tmp_path, {"t": TIME, "angle": TRAVEL % 360.0}, "time_s=t, measured_deg=angle:rad")
    assert found["units"].columns == "time_s=t, measured_deg=angle"


def test_explain_says_so_first(tmp_path: Path) -> None:
    """Counts a turn that are too few by four: the fits are well, and of a turn they say nothing."""
    path = tmp_path / "log.csv"
    path.write_text(csv_text({"t": TIME, "angle": COUNTS}))
    answer = explained(path, "--columns", "time_s=t, measured_deg=angle*360/4096", "--budget", "2")
    assert [one["kind"] for one in answer["setup"] if one["level"] == "fault"] == ["wrong_counts"]
    answer = explained(path, "--columns", "time_s=t, measured_deg=angle*360/16384", "--budget", "2")
    assert not answer["setup"]


def test_the_clock_is_checked_without_a_reference(tmp_path: Path) -> None:
    back = TIME.copy()
    back[[700, 701]] = back[[701, 700]]
    jitter = TIME + 3e-4 * np.random.default_rng(1).random(TIME.size)
    kept = np.delete(np.arange(TIME.size), [100, 101, 102, 900])
    reading = {"measured_deg": TRAVEL % 360.0}
    assert found_in(tmp_path, {"time_s": back, **reading})["time_backwards"].rows == (702,)
    assert "time_jitter" in found_in(tmp_path, {"time_s": jitter, **reading})
    gaps = found_in(tmp_path, {"time_s": TIME[kept], "measured_deg": (TRAVEL % 360.0)[kept]})
    assert list(gaps) == ["gaps_in_time"]
    assert "2 gaps" in gaps["gaps_in_time"].evidence
    assert "about 4 readings" in gaps["gaps_in_time"].evidence
    assert not found_in(tmp_path, {"time_s": TIME, **reading})


NO_TURN = {
    "rocks over 90": 120.0 + 45.0 * np.sin(9.0 * TIME),
    "stands still, at 12.3": np.full(TIME.size, 12.3),
    "stands still, at 359": 359.0 + 0.3 * np.random.default_rng(2).standard_normal(TIME.size),
    "turns by 200 deg in all": 200.0 * TIME / TIME[-1],
}


@pytest.mark.parametrize("words", NO_TURN)
def test_a_shaft_without_a_whole_turn_is_told_by_what_it_does(words: str, tmp_path: Path) -> None:
    columns = {"time_s": TIME, "measured_deg": NO_TURN[words] % 360.0}
    assert words in found_in(tmp_path, columns)["no_turning"].what
    with pytest.raises(SweepError, match=words):
        Spin.from_columns(columns)


def test_a_turn_that_the_counts_make_too_short_is_not_called_rocking() -> None:
    with pytest.raises(SweepError, match=r"begin anew after 89\.98 deg"):
        Spin.from_columns({"time_s": TIME, "measured_deg": COUNTS * 360.0 / 65536.0})


def test_channels_about_no_zero_are_told_so() -> None:
    channels = {"vx": 2048.0 + 1500.0 * np.cos(np.radians(TRAVEL)), "vy": 2048.0 + 1500.0 * np.sin(np.radians(TRAVEL))}
    with pytest.raises(SweepError, match=r"never changes its sign.*about 2048"):
        Spin.from_columns({"time_s": TIME, **channels})
    centred = {name: values - 2048.0 for name, values in channels.items()}
    assert len(Spin.from_columns({"time_s": TIME, **centred})) == TIME.size
