"""Logs that several statements fit: they are listed, and no fault is told that one of them makes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.command_line import csv_text, halltwin
from twin.angles import Array

ANGLE_DEG = np.arange(0.0, 720.0, 2.0)
EVEN_DEG = np.arange(64) * 360.0 / 64.0


def error_deg(at: Array) -> Array:
    return 0.8 * np.sin(np.radians(at)) + 0.3 * np.cos(np.radians(2.0 * at))


def answer_of(folder: Path, text: str) -> dict[str, Any]:
    log = folder / "log.csv"
    log.write_text(text)
    halltwin("doctor", log, "--json", folder / "found.json")
    answer: dict[str, Any] = json.loads((folder / "found.json").read_text(encoding="utf-8"))
    return answer


def of_two_angles(*, sensor_first: bool = False) -> str:
    """Two angles without a name that tells the sensor; one is set in even steps, the other scatters."""
    noise = 0.03 * np.random.default_rng(7).standard_normal(ANGLE_DEG.size)
    own = (ANGLE_DEG + 20.0 + error_deg(ANGLE_DEG) + noise) % 360.0
    columns = {"Geber [deg]": ANGLE_DEG % 360.0, "Nehmer [deg]": np.round(own, 3)}
    return csv_text(dict(reversed(columns.items())) if sensor_first else columns)


LOGS = {
    "two angles": of_two_angles(),
    "two angles, the sensor first": of_two_angles(sensor_first=True),
    "corrections beside a reading": csv_text({"reading_deg": EVEN_DEG, "correction_deg": -error_deg(EVEN_DEG)}),
    "single numbers": "\n".join(f"{one:.4f}" for one in error_deg(EVEN_DEG)) + "\n",
    "counts of a table": "int16_t correction[64] = {"
    + ", ".join(f"{one:.0f}" for one in -error_deg(EVEN_DEG) * 16384 / 360)
    + "};\n",
}


@pytest.mark.parametrize("name", LOGS)
def test_every_statement_that_fits_is_listed_and_none_is_taken(name: str, tmp_path: Path) -> None:
    answer = answer_of(tmp_path, LOGS[name])
    (found,) = answer["setup"]
    assert (found["kind"], found["level"], found["columns"]) == ("ambiguous", "fault", None)
    assert answer["log"]["read_as"] is None
    assert len(set(found["options"])) >= 2
    for option in found["options"]:
        assert halltwin("import", tmp_path / "log.csv", "--columns", option).code == 0
    # The very ones that are asked back when it is imported.
    assert f'"{found["options"][0]}"' in halltwin("import", tmp_path / "log.csv").err


def test_options_are_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    (tmp_path / "log.csv").write_text(LOGS["two angles"])
    said = halltwin("doctor", tmp_path / "log.csv", "--fail-on", "ambiguous")
    assert said.code == 1
    assert said.out.count("--columns") == 2
    assert "read as" not in said.out


def test_what_is_wrong_in_every_reading_is_told(tmp_path: Path) -> None:
    """Both columns are as good as each other, and neither was read on more than half of the turn."""
    at = np.arange(0.0, 170.0, 1.0)
    table = {"Geber [deg]": at, "Nehmer [deg]": np.round(at + 5.0 + error_deg(at), 3)}
    assert [one["kind"] for one in answer_of(tmp_path, csv_text(table))["setup"]] == ["ambiguous", "part_of_a_turn"]


def test_a_table_with_a_unit_in_its_name_is_read(tmp_path: Path) -> None:
    entries = ", ".join(f"{one:.0f}" for one in -100.0 * error_deg(EVEN_DEG))
    answer = answer_of(tmp_path, f"/* added, entry k at k */ const int16_t correction_cdeg[64] = {{{entries}}};\n")
    assert answer["log"]["read_as"] == "reference_deg=index*360/64+correction_cdeg:cdeg, measured_deg=index*360/64"
    assert answer["setup"] == []


def test_explain_of_a_table_says_what_it_is_and_how_many_statements_fit(tmp_path: Path) -> None:
    (tmp_path / "table.h").write_text("/* corrections, entry k at k*360/64 */\n" + LOGS["counts of a table"])
    ended = halltwin("explain", tmp_path / "table.h")
    assert ended.code == 2
    assert (
        "table.h: holds a table of 64 entries, and no columns of a sweep; say what is meant (several guesses fit"
        in ended.err
    )
    assert "/*" not in ended.err
    assert ended.err.count("--columns") == 2
    assert ", and " in ended.err
    assert ended.err.rstrip().endswith(" more")


@pytest.mark.parametrize("column", ["tick", "raw_counts"])
def test_what_is_hardly_a_reference_is_none(column: str, tmp_path: Path) -> None:
    """A counter of rows, and the sensor's own counts: the sensor stands alone, and the option is told."""
    at = np.arange(500) * 360.0 / 500.0
    angle = np.round((at + 41.0 + error_deg(at)) % 360.0, 3)
    beside = np.arange(500.0) if column == "tick" else np.round(angle * 4096.0 / 360.0) % 4096
    answer = answer_of(tmp_path, csv_text({column: beside, "angle_deg": angle}))
    assert answer["log"]["columns"] == ["measured_deg"]
    (found,) = (one for one in answer["setup"] if one["kind"] == "no_reference")
    assert column in found["what"]
    assert found["columns"].startswith(f"reference_deg={column}*360/")
