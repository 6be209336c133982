"""``halltwin doctor`` and the set-up in ``explain``: exit codes, the reason of a refusal, the first block."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.command_line import csv_text, halltwin

ANGLE_DEG = np.arange(0.0, 720.0, 3.0)


def written(folder: Path, **columns: np.ndarray) -> Path:
    path = folder / "log.csv"
    path.write_text(csv_text({"reference_deg": ANGLE_DEG, **columns}))
    return path


def axial(folder: Path) -> Path:
    return written(folder, measured_deg=205.0 + 25.0 * np.sin(np.radians(ANGLE_DEG)))


def right(folder: Path) -> Path:
    noise = 0.05 * np.random.default_rng(1).standard_normal(ANGLE_DEG.size)
    return written(folder, measured_deg=(ANGLE_DEG + 0.8 * np.sin(np.radians(ANGLE_DEG)) + noise) % 360.0)


@pytest.mark.parametrize("command", ["explain", "diagnose"])
def test_a_refusal_carries_the_reason(command: str, tmp_path: Path) -> None:
    ended = halltwin(command, axial(tmp_path))
    assert ended.code == 2
    assert "axial instead of diametral, or not over the sensor" in ended.err


@pytest.mark.parametrize(("words", "code"), [((), 0), (("fault",), 1), (("axial_magnet",), 1), (("note",), 0)])
def test_a_script_stops_at_what_it_names(words: tuple[str, ...], code: int, tmp_path: Path) -> None:
    options = [part for word in words for part in ("--fail-on", word)]
    assert halltwin("doctor", axial(tmp_path), *options).code == code


def test_a_word_that_is_none_is_refused_before_the_log_is_read(tmp_path: Path) -> None:
    ended = halltwin("doctor", tmp_path / "missing.csv", "--fail-on", "axial")
    assert ended.code == 2
    assert "--fail-on" in ended.err


def test_nothing_is_said_of_a_set_up_that_is_right(tmp_path: Path) -> None:
    assert "Set-up: nothing wrong found" in halltwin("doctor", right(tmp_path)).out


def test_a_log_without_a_reference_gets_its_finding(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(csv_text({"time_s": 0.001 * ANGLE_DEG, "measured_deg": ANGLE_DEG % 360.0}))
    halltwin("doctor", path, "--json", tmp_path / "found.json")
    answer = json.loads((tmp_path / "found.json").read_text())
    assert [found["kind"] for found in answer["setup"]] == ["no_reference"]


def test_a_check_says_that_its_column_is_there_and_not_used(tmp_path: Path) -> None:
    """A counter whose numbers are none of a bench, and a status in words, each under its own name."""
    path = written(tmp_path, measured_deg=(ANGLE_DEG + 0.8 * np.sin(np.radians(ANGLE_DEG))) % 360.0)
    head, *rows = path.read_text().splitlines()
    path.write_text("\n".join([f"{head},frame_no,status", *(f"{row},{k}e300,ok" for k, row in enumerate(rows)), ""]))
    out = " ".join(halltwin("doctor", path).out.split())
    assert "not used: frame_no (holds numbers up to 2.39e+302, beyond 1e+20), status (holds words)" in out
    assert "lost_frames (frame_no not used, see above); other_status (status not used, see above)" in out
    assert "read_late (no speed_rpm)" in out


def test_explain_begins_with_what_has_to_be_mended(tmp_path: Path) -> None:
    """A table of 24 angles, in one of whose rows two digits are exchanged."""
    shaft = np.arange(0.0, 360.0, 15.0)
    reading = shaft + 0.8 * np.sin(np.radians(shaft)) + 0.02 * np.random.default_rng(2).standard_normal(shaft.size)
    reading[12] += 9.0
    path = tmp_path / "log.csv"
    path.write_text(csv_text({"reference_deg": shaft, "measured_deg": reading}))
    ended = halltwin("explain", path, "--json", tmp_path / "found.json", "--report", tmp_path / "report.html")
    block = ended.out.split("\n\n")[1]
    assert block.startswith("Set-up, to be mended first")
    assert "typing_error" in block
    found = json.loads((tmp_path / "found.json").read_text())["setup"]
    assert [(one["kind"], one["rows"]) for one in found] == [("typing_error", [13])]
    assert "Set-up, to be mended first" in (tmp_path / "report.html").read_text(encoding="utf-8")
