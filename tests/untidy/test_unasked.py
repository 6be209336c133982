"""Logs under names of their own in every command: read by the one statement that fits, which is told, or refused."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from tests.command_line import halltwin
from tests.untidy.generator import MEASURED_DEG, REFERENCE_DEG, ROWS, TIME_S, counts, table
from twin.errors import SweepError
from twin.logs.unasked import LARGEST_READ_TWICE
from twin.sweep import Sweep

OPTION = re.compile(r'--columns "([^"]*)"')
LOG = {"ref_deg": REFERENCE_DEG, "AS5600 raw": counts(MEASURED_DEG, 4096), "junk": np.sin(np.arange(ROWS) ** 2.0)}
STATEMENT = "reference_deg=ref_deg, measured_deg='AS5600 raw'*360/4096"


def written(folder: Path, columns: dict[str, np.ndarray], name: str = "log.csv") -> Path:
    path = folder / name
    path.write_text(table(columns))
    return path


@pytest.mark.parametrize("command", ["explain", "diagnose", "compensate", "monitor"])
def test_a_log_that_fits_one_statement_alone_is_read_by_it(command: str, tmp_path: Path) -> None:
    """And the statement is told, with what is not used: said as an option, it gives the same."""
    path = written(tmp_path, LOG)
    guessed = halltwin(command, path)
    assert OPTION.findall(guessed.err) == [STATEMENT]
    assert "not used: junk" in guessed.err
    said = halltwin(command, path, "--columns", STATEMENT)
    assert (guessed.code, guessed.out) == (said.code, said.out)
    assert said.err in guessed.err


def test_what_is_taken_for_granted_is_told_and_kept(tmp_path: Path) -> None:
    path, answer = written(tmp_path, {**LOG, "temp": np.full(ROWS, 68.0)}), tmp_path / "answer.json"
    ended = halltwin("explain", path, "--json", answer)
    assert "taken for granted: temp is taken in C" in ended.err
    sweep = json.loads(answer.read_text())["sweep"]
    assert sweep["read_as"] == f"{STATEMENT}, temperature_c=temp"
    assert (sweep["notes"], sweep["not_used"]) == (["temp is taken in C"], ["junk"])


def test_logs_that_are_read_alike_are_told_of_once(tmp_path: Path) -> None:
    paths = [written(tmp_path, LOG, f"log{k}.csv") for k in range(5)]
    ended = halltwin("monitor", *paths)
    assert OPTION.findall(ended.err) == [STATEMENT]
    assert "log0.csv, log1.csv, log2.csv and 2 more: read as" in ended.err


def test_a_fleets_logs_are_read_alike(tmp_path: Path) -> None:
    """By the guess of the first ones; those that another guess fits are named."""
    rng = np.random.default_rng(3)
    for k in range(12):
        noisy = (MEASURED_DEG + 0.05 * rng.standard_normal(ROWS)) % 360.0
        written(tmp_path, {"ref_deg": REFERENCE_DEG, "sensor_deg": noisy}, f"d{k:02}.csv")
    ended = halltwin("fleet", tmp_path, "-o", tmp_path / "study")
    assert ended.code == 0
    assert OPTION.findall(ended.err) == ["reference_deg=ref_deg, measured_deg=sensor_deg"]
    written(tmp_path, {"ref_deg": REFERENCE_DEG, "sensor_rad": np.radians(MEASURED_DEG)}, "d12.csv")
    ended = halltwin("fleet", tmp_path, "-o", tmp_path / "other")
    assert ended.code == 2
    assert "d12.csv" in ended.err
    assert "sensor_rad:rad" in ended.err


def test_names_in_capitals_are_those_names(tmp_path: Path) -> None:
    """Some of them in capitals, too."""
    for names in (("Reference_Deg", "MEASURED_DEG"), ("reference_deg", "Measured_deg")):
        ended = halltwin("diagnose", written(tmp_path, dict(zip(names, (REFERENCE_DEG, MEASURED_DEG), strict=True))))
        assert ended.code == 0
        assert OPTION.findall(ended.err) == [f"reference_deg={names[0]}, measured_deg={names[1]}"]


def test_what_goes_against_a_sweeps_own_names_is_refused_and_told(tmp_path: Path) -> None:
    path = written(tmp_path, {"reference_deg": REFERENCE_DEG, "measured_counts": counts(MEASURED_DEG, 4096)})
    ended = halltwin("explain", path)
    assert ended.code == 2
    assert OPTION.findall(ended.err)


def test_what_is_wrong_under_the_statement_that_fits_is_told(tmp_path: Path) -> None:
    few = slice(0, 5)
    ended = halltwin("explain", written(tmp_path, {"encoder_deg": REFERENCE_DEG[few], "hall_deg": MEASURED_DEG[few]}))
    assert ended.code == 2
    assert "5 usable rows; expected at least 8" in ended.err
    assert 'read as --columns "reference_deg=encoder_deg, measured_deg=hall_deg"' in ended.err


def test_a_long_log_is_read_by_its_guess(tmp_path: Path) -> None:
    """That a sweep's columns are missing is told by its first line."""
    many = LARGEST_READ_TWICE // 20
    angle = np.linspace(0.0, 3600.0, many)
    path = written(tmp_path, {"ref_deg": angle, "sensor_deg": angle + np.sin(np.radians(angle))})
    assert path.stat().st_size > LARGEST_READ_TWICE
    found = Sweep.read(path, guess=True)
    assert len(found) == many
    assert found.read_as is not None
    assert found.read_as.text == "reference_deg=ref_deg, measured_deg=sensor_deg"


def test_from_python_a_guess_is_asked_for(tmp_path: Path) -> None:
    path = written(tmp_path, LOG)
    with pytest.raises(SweepError, match=r"AS5600 raw'\*360/4096"):
        Sweep.read(path)
    assert Sweep.read(path, guess=True).read_as is not None
    own = written(tmp_path, {"reference_deg": REFERENCE_DEG, "measured_deg": MEASURED_DEG}, "own.csv")
    assert Sweep.read(own, guess=True).read_as is None


def test_a_spin_keeps_how_it_was_read(tmp_path: Path) -> None:
    at = TIME_S * 0.4
    turning = (2000.0 * at + np.sin(np.radians(2000.0 * at))) % 360.0
    path, answer = written(tmp_path, {"time_s": at, "sensor_deg": turning}), tmp_path / "answer.json"
    ended = halltwin("explain", path, "--json", answer)
    assert OPTION.findall(ended.err) == ["time_s=time_s, measured_deg=sensor_deg"]
    assert json.loads(answer.read_text())["sweep"]["read_as"] == "time_s=time_s, measured_deg=sensor_deg"


def test_why_nothing_fits_is_told_with_an_example(tmp_path: Path) -> None:
    ended = halltwin("explain", written(tmp_path, {"travel_mm": REFERENCE_DEG, "sensor_deg": MEASURED_DEG}))
    assert ended.code == 2
    assert "no two columns are angles that follow each other" in ended.err
    assert OPTION.findall(ended.err) == ["reference_deg=NAME*360/4096, measured_deg=NAME:rad"]
