"""The commands on logs of a sensor alone: what a correction of them warns of, and what a report says of them."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.command_line import Array, csv_text, explained, halltwin

TIME = np.arange(0.0, 8.0, 0.001)
COAST = np.linspace(27.0, 6.0, TIME.size)
"""Turns a second."""


def words_of(angle_deg: Array) -> Array:
    """An angle as a sensor of 14 bits gives it, in degrees."""
    return np.floor(angle_deg * 16384.0 / 360.0) % 16384.0 * 360.0 / 16384.0


def log(folder: Path, turns_per_s: Any = 3.0, *, name: str = "log.csv", seed: int = 5, error: float = 1.0) -> Path:
    """A shaft whose cogging, of order 4, swings it, and a sensor of 14 bits with an error of orders 1 and 2."""
    speed = np.broadcast_to(np.asarray(turns_per_s, dtype=np.float64), TIME.shape)
    angle = 360.0 * (np.cumsum(speed) - speed[0]) * 0.001
    turn = np.radians(angle)
    swing = 0.4 * (3.0 / speed) ** 2 * np.sin(4.0 * turn + 0.4)
    noise = 0.02 * np.random.default_rng(seed).standard_normal(TIME.size)
    own = error * (0.8 * np.sin(turn + 0.5) + 0.35 * np.sin(2.0 * turn - 1.0))
    reading = angle + swing + 123.0 + own + noise
    path = folder / name
    path.write_text(csv_text({"time_s": TIME, "measured_deg": words_of(reading)}))
    return path


def test_a_word_of_few_bits_hides_no_torque(tmp_path: Path) -> None:
    """The steps of the word make of one order many; a torque of that order is among what may be meant all the same."""
    angle = 3240.0 * TIME[:4000]
    reading = angle + 0.5 * np.cos(np.radians(5.0 * angle)) + 0.03 * np.random.default_rng(1).standard_normal(4000)
    path, report = tmp_path / "log.csv", tmp_path / "report.html"
    path.write_text(csv_text({"time_s": TIME[:4000], "measured_deg": words_of(reading)}))
    (cause,) = explained(path, "--report", report)["causes"]
    assert cause["parameters"]["order"]["value"] == 5.0
    assert "torque_ripple" in cause["indistinguishable_from"]
    assert "a log at a second speed" in cause["to_tell_apart"]
    page = report.read_text(encoding="utf-8")
    assert "Without a reference" in page
    assert "Not told from a torque locked to the angle: orders 1 to 32" in page


@pytest.mark.parametrize(("speeds", "open_orders"), [(3.0, "orders 1 to 32"), (COAST, "")])
def test_a_correction_says_what_of_it_may_be_a_torque(speeds: Any, open_orders: str, tmp_path: Path) -> None:
    path = log(tmp_path, speeds)
    files = [tmp_path / name for name in ("table.csv", "header.h", "table.toml")]
    ended = halltwin("compensate", path, "--table", files[0], "--header", files[1], "--toml", files[2])
    assert ended.code == 0, ended.err
    for said in (ended.out, *(file.read_text() for file in files[1:])):
        words = " ".join(said.replace("\n *", " ").split())
        assert "made without a reference" in words
        assert ("orders 1 to 32 of it may be a torque's" in words) == bool(open_orders)
        assert ("a log at a second speed" in words) == bool(open_orders)
    assert tomllib.loads(files[2].read_text())["not_separable"] == (list(range(1, 33)) if open_orders else [])
    assert "as the reference counted it" not in files[1].read_text()


def test_its_gain_is_told_with_what_torques_do(tmp_path: Path) -> None:
    held_out = "on held-out blocks, torques included"
    assert held_out in " ".join(halltwin("compensate", log(tmp_path)).out.split())
    assert held_out not in halltwin("compensate", log(tmp_path, COAST)).out


def test_a_correction_is_tried_on_another_log_without_a_reference(tmp_path: Path) -> None:
    made_of, other = log(tmp_path, COAST), log(tmp_path, COAST[::-1], name="other.csv", seed=6)
    ended = halltwin("compensate", made_of, "--check", other)
    assert ended.code == 0, ended.err
    assert left_on(ended.out, "other.csv") < 0.1
    assert "other.csv: no reference: the errors are told against the shaft's own even turning" in ended.out
    at_one_speed = log(tmp_path, name="slow.csv", seed=6)
    said = " ".join(halltwin("compensate", made_of, "--check", at_one_speed).out.split())
    assert "turning, and in orders 1 to 32 with what torques turn it by" in said


def test_logs_for_a_check_need_not_be_of_one_device(tmp_path: Path) -> None:
    """A motion that was estimated from both would hold what they differ by."""
    made_of, same = log(tmp_path, COAST), log(tmp_path, COAST[::-1], name="same.csv", seed=6)
    other = log(tmp_path, 0.7 * COAST, name="other.csv", seed=7, error=-1.0)
    ended = halltwin("compensate", made_of, "--check", same, "--check", other)
    assert ended.code == 1
    assert left_on(ended.out, "same.csv") < 0.1 < 1.0 < left_on(ended.out, "other.csv")
    assert "the correction makes the error larger on other.csv (" in ended.err


def test_what_torques_may_do_is_no_fault_of_the_correction(tmp_path: Path) -> None:
    """At one speed the cogging is as good an error of the sensor."""
    made_of, other = log(tmp_path, COAST), log(tmp_path, name="other.csv", seed=6, error=-1.0)
    ended = halltwin("compensate", made_of, "--check", other)
    assert ended.code == 0, ended.err
    assert "larger with the correction on other.csv (" in ended.out
    assert "by the sensor or by torques" in ended.out


def test_a_correction_is_made_of_logs_with_a_reference_or_of_those_without(tmp_path: Path) -> None:
    angle = 360.0 * 3.0 * TIME
    both = tmp_path / "both.csv"
    both.write_text(csv_text({"time_s": TIME, "reference_deg": angle % 360.0, "measured_deg": words_of(angle)}))
    ended = halltwin("compensate", both, log(tmp_path, COAST))
    assert ended.code == 2
    assert "log.csv has no reference_deg, and others have one" in ended.err


def test_rows_that_tell_no_turning_are_counted(tmp_path: Path) -> None:
    """A shaft that stands still for the last two seconds."""
    path = log(tmp_path, COAST)
    lines = path.read_text().splitlines()
    stands = [f"{line.split(',')[0]},{lines[6000].split(',')[1]}" for line in lines[6001:]]
    path.write_text("\n".join([*lines[:6001], *stands, ""]))
    out = halltwin("compensate", path).out
    counted = re.search(r"log.csv: (\d+) rows without an even turning are left out", out)
    assert counted is not None, out
    assert 2000 <= int(counted[1]) < 3000


def left_on(out: str, name: str) -> float:
    """RMS [deg] that a correction leaves of the readings of this name."""
    found = re.search(rf"on {re.escape(name)} +\S+ -> (\S+)", out)
    assert found is not None, out
    return float(found.group(1))


def test_a_drives_table_says_it_too(tmp_path: Path) -> None:
    table, answer = tmp_path / "table.h", tmp_path / "answer.json"
    ended = halltwin("export", log(tmp_path), "--for", "simplefoc", "-o", table, "--json", answer)
    assert ended.code == 0, ended.err
    for said in (ended.out, table.read_text().replace("\n *", " ")):
        assert "orders 1 to 32 of it may be a torque's" in " ".join(said.split())
    assert json.loads(answer.read_text())["not_separable"] == list(range(1, 33))


def test_a_reference_leaves_nothing_to_be_said(tmp_path: Path) -> None:
    angle = np.arange(0.0, 720.0, 2.0)
    path = tmp_path / "sweep.csv"
    path.write_text(csv_text({"reference_deg": angle, "measured_deg": (angle + np.cos(np.radians(angle))) % 360.0}))
    files = [tmp_path / name for name in ("table.csv", "header.h", "table.toml")]
    ended = halltwin("compensate", path, "--table", files[0], "--header", files[1], "--toml", files[2])
    assert ended.code == 0, ended.err
    for said in (ended.out, *(file.read_text() for file in files)):
        assert "without a reference" not in said
    assert "as the reference counted it" in files[1].read_text()


def test_logs_of_two_speeds_make_one_correction(tmp_path: Path) -> None:
    """The cogging, 0.4 deg at the slower of them, is told from the sensor's orders 1 and 2, and is not in the table."""
    paths = [log(tmp_path, 3.0, name="slow.csv"), log(tmp_path, 9.0, name="fast.csv", seed=6)]
    table = tmp_path / "table.csv"
    ended = halltwin("compensate", *paths, "--table", table)
    assert ended.code == 0, ended.err
    assert "orders 1 to 32 of it may be a torque's" not in " ".join(ended.out.split())
    rows = np.genfromtxt(table, delimiter=",", skip_header=1)
    reading, added = np.radians(rows[:, 0]), rows[:, 1]
    sizes = [abs(2.0 * np.mean(added * np.exp(-1j * order * reading))) for order in (1, 2, 4)]
    assert sizes[:2] == pytest.approx([0.8, 0.35], abs=0.02)
    assert sizes[2] < 0.04
