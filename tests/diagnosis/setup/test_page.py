"""The page on the set-up shows what ``doctor`` says, and lists what it checks."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from diagnosis.setup.checks import KINDS
from tests.command_line import halltwin
from tests.pages import GUIDE, block, lines
from tests.test_nomenclature import undescribed

PAGE = GUIDE / "setup.md"
POLE_PAIRS = 7


def motor_log(folder: Path) -> Path:
    """A motor's shaft and its electrical angle, over a bus that lost three frames."""
    row = np.setdiff1d(np.arange(400), [57, 58, 311])
    shaft = 1.8 * row + 11.0
    electrical = (POLE_PAIRS * shaft + 0.8 * np.sin(np.radians(shaft)) + 40.0) % 360.0
    text = [f"{k % 256},{angle:.4f},{reading:.3f}" for k, angle, reading in zip(row, shaft, electrical, strict=True)]
    path = folder / "motor.csv"
    path.write_text("\n".join(["frame,encoder_deg,hall_angle_deg", *text]) + "\n")
    return path


def test_the_page_shows_what_doctor_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    assert lines(halltwin("doctor", motor_log(tmp_path)).out) == lines(block(PAGE, "doctor"))


def test_the_page_lists_every_kind() -> None:
    rows = re.findall(r"^\| (`.*?) \|", PAGE.read_text(encoding="utf-8"), re.M)
    assert {kind for row in rows for kind in re.findall(r"`(\w+)`", row)} >= set(KINDS)


def test_keys_of_doctor_are_listed(tmp_path: Path) -> None:
    halltwin("doctor", motor_log(tmp_path), "--json", tmp_path / "found.json")
    answer = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))
    assert [found["kind"] for found in answer["setup"]] == ["pole_pairs", "lost_frames"]
    answer["not_checked"] = {}
    assert undescribed(answer) == set()


def test_the_statement_that_mends_a_finding_makes_a_sweep(tmp_path: Path) -> None:
    log = motor_log(tmp_path)
    halltwin("doctor", log, "--json", tmp_path / "found.json")
    mends = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))["setup"][0]["columns"]
    assert halltwin("import", log, "--columns", mends).code == 0
