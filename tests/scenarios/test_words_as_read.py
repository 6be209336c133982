"""Figures of a correction are those of the words that a drive reads, faults and all; what is left adds up to them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis.correction.targets import lut, simplefoc
from tests.command_line import halltwin
from tests.test_nomenclature import undescribed
from twin.angles import Array, wrap

REFERENCE_DEG = 2.0 * np.arange(360)
NOISE_DEG = 0.03
ZERO_DEG = 41.0
BITS = 12


def readings(seed: int = 5, sense: int = 1) -> Array:
    """A sensor's angles (360,) [deg] over two turns: orders 1 and 2 of 1.2 and 0.5 deg, and noise."""
    turn = np.radians(REFERENCE_DEG)
    error = 1.2 * np.sin(turn + 0.5) + 0.5 * np.sin(2.0 * turn + 1.2)
    noise = np.random.default_rng(seed).normal(0.0, NOISE_DEG, turn.size)
    return np.asarray((sense * (REFERENCE_DEG + error) + ZERO_DEG + noise) % 360.0)


def words(seed: int = 5) -> Array:
    """The same as words (360,) of 12 bit."""
    return np.round(readings(seed) / 360.0 * 2**BITS).astype(np.int64) % 2**BITS


def written(path: Path, measured_deg: Array, reference_deg: Array = REFERENCE_DEG, **more: Array) -> Path:
    """A sweep's file."""
    columns = {"reference_deg": reference_deg % 360.0, "measured_deg": measured_deg, **more}
    np.savetxt(path, np.column_stack(list(columns.values())), "%.6f", ",", header=",".join(columns), comments="")
    return path


def with_stuck_bit(bit: int) -> Array:
    return np.asarray((words() & ~(1 << bit)) / 2**BITS * 360.0)


def with_dead_zone() -> Array:
    measured = readings()
    return np.where(measured > 350.0, 350.0, measured)


def with_code() -> Array:
    return np.where(np.random.default_rng(3).random(360) < 0.03, 0.0, words() / 2**BITS * 360.0)


FAULTS = {
    "word_bit": with_stuck_bit(5),
    "word_bit of the top": with_stuck_bit(BITS - 1),
    "dead_zone": with_dead_zone(),
    "error_code": with_code(),
}


def rms_deg(error_rad: Array) -> float:
    """RMS [deg] about the mean on the circle."""
    mean = np.angle(np.mean(np.exp(1j * error_rad)))
    return float(np.degrees(np.sqrt(np.mean(wrap(error_rad - mean) ** 2))))


def figures(out: str, row: str) -> list[float]:
    """RMS before and after of the row of figures that begins so."""
    (found,) = re.findall(rf"^ *{re.escape(row)} +([\d.]+) -> ([\d.]+) ", out, re.MULTILINE)
    return [float(value) for value in found]


def exported(path: Path, folder: Path, *arguments: str | Path, target: str = "simplefoc") -> tuple[str, dict[str, Any]]:
    """What is printed, and the JSON."""
    ended = halltwin("export", path, "--for", target, "--json", folder / "answer.json", "--force", *arguments)
    assert (ended.code, ended.err) == (0, "")
    told: dict[str, Any] = json.loads((folder / "answer.json").read_text(encoding="utf-8"))
    assert undescribed(told) == set()
    return ended.out, told


@pytest.mark.parametrize("fault", FAULTS)
def test_a_table_is_judged_on_the_words_that_the_drive_reads(
    fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The written table on the log's own words errs as told, within what held-out readings err more."""
    monkeypatch.setenv("COLUMNS", "120")
    measured, file = FAULTS[fault], tmp_path / "table.h"
    path = written(tmp_path / "sweep.csv", measured)
    out, told = exported(path, tmp_path, "-o", file)
    table = simplefoc.TARGET.read(file.read_text(encoding="utf-8"))
    real = rms_deg(table.corrected(np.radians(measured)) - np.radians(REFERENCE_DEG))
    assert real > 0.5
    before, after = figures(out, "each turn's own zero taken out")
    assert before == pytest.approx(rms_deg(np.radians(measured - REFERENCE_DEG)), rel=0.02)
    assert after == pytest.approx(real, rel=0.02)
    as_read, sound = told["judged"]
    assert as_read["rms_deg_after"] > 0.99 * real
    # The words' steps of 0.088 deg and the noise: what is left once the link is mended.
    assert sound["rms_deg_after"] < 1.2 * np.hypot(NOISE_DEG, 360.0 / 2**BITS / np.sqrt(12.0))
    left = {one["what"]: one for one in told["not_removed"]}
    assert left["faults of the word"]["causes"] == [fault.split()[0]]
    assert left["faults of the word"]["rms_deg"] == pytest.approx(as_read["rms_deg_after"], rel=0.05)
    assert f"Not removed: faults of the word ({fault.split()[0]})" in file.read_text(encoding="utf-8")


@pytest.mark.parametrize("fault", FAULTS)
def test_a_checked_sweep_is_judged_as_it_is_read_by_both_commands(
    fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    sound = written(tmp_path / "sound.csv", readings(6))
    bad = written(tmp_path / "bad.csv", FAULTS[fault])
    expected = rms_deg(np.radians(FAULTS[fault] - REFERENCE_DEG))
    for command in (("compensate",), ("export", "--for", "lut")):
        for ended in (halltwin(*command, bad), halltwin(*command, sound, "--check", bad)):
            assert (ended.code, ended.err) == (0, "")
            before, after = figures(ended.out, "each turn's own zero taken out")
            assert before == pytest.approx(expected, rel=0.02)
            assert after > 0.5
            assert f"faults of the word ({fault.split()[0]}): " in ended.out


def test_a_wrong_table_is_told_by_the_words_that_say_the_angle(tmp_path: Path) -> None:
    """That of a sensor whose error is the opposite: a code's rows, of 17 deg RMS, neither hide it nor make it up."""
    opposite = (2.0 * (REFERENCE_DEG + ZERO_DEG) - readings(6)) % 360.0
    wrong, bad = written(tmp_path / "wrong.csv", opposite), written(tmp_path / "bad.csv", with_code())
    count = np.count_nonzero(with_code() == 0.0)
    for command in (("compensate",), ("export", "--for", "c")):
        ended = halltwin(*command, wrong, "--check", bad)
        assert ended.code == 1
        said = " ".join(ended.err.split())
        found = re.search(
            r"bad\.csv, words as they are read, (\d+) readings .* left out \(([\d.]+) -> ([\d.]+) deg", said
        )
        assert found is not None
        assert int(found[1]) == count
        # Orders 1 and 2 of 1.2 and 0.5 deg, and twice that.
        assert [float(value) for value in found.groups()[1:]] == pytest.approx([0.92, 1.84], rel=0.03)


@pytest.mark.parametrize("sense", [1, -1])
def test_a_plain_table_is_applied_as_its_sentence_says(sense: int, tmp_path: Path) -> None:
    """By the printed formula, and by its column of shaft angles: both lead to the reference, zero and all."""
    path, file = written(tmp_path / "sweep.csv", readings(sense=sense)), tmp_path / "table.csv"
    out, told = exported(path, tmp_path, "-o", file, target="lut")
    assert told["formula"] in " ".join(out.split())
    found = re.fullmatch(r"shaft angle = (-?)reading \+ correction_deg ([+-]) ([\d.]+) deg", told["formula"])
    assert found is not None
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    measured = readings(sense=sense)
    correction = np.interp(measured, table[:, 0], table[:, 1], period=360.0)
    shaft = float(f"{found[1]}1") * measured + correction + float(found[2] + found[3])
    limit = 1.2 * NOISE_DEG
    assert np.degrees(np.sqrt(np.mean(wrap(np.radians(shaft - REFERENCE_DEG)) ** 2))) < limit
    columns = lut.TARGET.read(file.read_text(encoding="utf-8")).corrected(np.radians(measured))
    assert np.degrees(np.sqrt(np.mean(wrap(columns - np.radians(REFERENCE_DEG)) ** 2))) < limit


def test_noise_is_told_apart_from_what_follows_a_current(tmp_path: Path) -> None:
    current = np.linspace(5.0, 13.0, 1440)
    turn = np.radians(np.arange(1440.0))
    follows = 0.15 * current * np.sin(turn + 1.0)
    noise = np.random.default_rng(2).normal(0.0, NOISE_DEG, 1440)
    reference = np.arange(1440.0)
    path = written(tmp_path / "sweep.csv", (reference + follows + noise) % 360.0, reference, current_a=current)
    _, told = exported(path, tmp_path)
    left = {one["what"]: one["rms_deg"] for one in told["not_removed"]}
    # By second differences of 1440 readings noise is known to 2.6 %, four times over.
    assert left["noise"] == pytest.approx(NOISE_DEG, rel=0.11)
    # A current from 5 to 13 A: 2.31 A RMS about its mean, times 0.15 deg, times that of a sine.
    assert left["else"] == pytest.approx(0.15 * 8.0 / np.sqrt(12.0) / np.sqrt(2.0), rel=0.05)


def test_what_is_left_adds_up_to_the_error_on_held_out_readings(tmp_path: Path) -> None:
    """A backlash there and back: where one direction is held out, the table does not lean to the other."""
    there = 2.0 * np.arange(360)
    reference = np.concatenate([there, there[::-1]])
    way = np.repeat([1.0, -1.0], 360)
    noise = np.random.default_rng(4).normal(0.0, NOISE_DEG, 720)
    error = 1.2 * np.sin(np.radians(reference)) + 0.3 * way
    _, told = exported(written(tmp_path / "sweep.csv", (reference + error + noise) % 360.0, reference), tmp_path)
    left = {one["what"]: one for one in told["not_removed"]}
    assert list(left) == ["direction", "noise"]
    assert left["direction"]["rms_deg"] == pytest.approx(0.3, rel=0.02)
    assert left["noise"]["rms_deg"] == pytest.approx(NOISE_DEG, rel=0.15)
    (judged,) = told["judged"]
    total = np.sqrt(sum(one["rms_deg"] ** 2 for one in left.values()))
    assert total == pytest.approx(judged["rms_deg_after"], rel=0.01)
