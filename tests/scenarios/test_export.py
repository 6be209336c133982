"""halltwin export: a drive's table from a sweep or a twin, judged on readings it never saw."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis.correction.targets import autosar, klipper, lut, magalpha, simplefoc
from diagnosis.correction.targets.target import Target
from tests.command_line import halltwin
from tests.pages import ROOT
from tests.test_nomenclature import undescribed
from twin.angles import TAU, wrap
from twin.chain import Chain
from twin.files import write_twin
from twin.motion import Motion
from twin.sweep import Sweep

NOISE_DEG = 0.02


def name_of(target: Target) -> str:
    """What a case is called."""
    return target.name


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep of a sensor that counts against the reference, a fresh one of it, and twins."""
    here = tmp_path_factory.mktemp("export")
    sensor = Chain(sensor_sense=-1).with_effect("zero", zero_deg=77.0).with_effect("offset", x_percent=1.0)
    sensor = sensor.with_effect("gain_mismatch", ratio=1.01).with_effect("magnet_harmonic", order=5, amplitude_deg=0.1)
    sensor = sensor.with_effect("noise", rms_deg=NOISE_DEG)
    for name, seed, first in (("sweep", 1, 0.0), ("fresh", 2, 0.3)):
        motion = Motion.from_angle(TAU * (np.arange(360) + first) / 180)
        sensor.simulate(motion, seed=seed).write(here / f"{name}.csv")
    write_twin(here / "sensor.toml", sensor)
    rich = sensor.with_effect("hysteresis", lag_deg=0.118, memory_deg=8.4).with_effect("latency", delay_us=20.0)
    rich = rich.with_effect("offset_drift", x_percent_per_K=0.004).with_effect("output_quantisation", bits=12)
    write_twin(here / "rich.toml", rich)
    write_twin(here / "other.toml", Chain(sensor_sense=-1).with_effect("offset", x_percent=-3.0))
    return here


def answer(folder: Path, *arguments: str | Path, name: str = "answer.json") -> dict[str, Any]:
    """The JSON of an export, which must end well."""
    ended = halltwin("export", *arguments, "--json", folder / name, "--force")
    assert (ended.code, ended.err) == (0, "")
    told: dict[str, Any] = json.loads((folder / name).read_text(encoding="utf-8"))
    return told


@pytest.mark.parametrize(
    "target", [simplefoc.TARGET, klipper.TARGET, magalpha.TARGET, autosar.TARGET, lut.TARGET], ids=name_of
)
def test_of_a_sweep_leaves_the_noise_alone(target: Target, folder: Path) -> None:
    """On held-out blocks, and on a fresh sweep by the file itself, as a model of the target reads it.

    Of the noise, what the curve is known to (a dozen figures from 360 readings), and what the words of the sensor round
    to: MagAlpha counts in 0.09 deg.
    """
    file = folder / f"table{target.ending}"
    told = answer(folder, folder / "sweep.csv", "--for", target.name, "-o", file)
    limit = 1.1 * np.hypot(NOISE_DEG, 0.088 / np.sqrt(12.0) if target is magalpha.TARGET else 0.0)
    (held_out,) = told["judged"]
    assert held_out["rms_deg_before"] > 0.3
    assert held_out["rms_deg_after"] < limit
    table = target.read(file.read_text(encoding="utf-8"))
    fresh = Sweep.read(folder / "fresh.csv")
    corrected = table.corrected(np.radians(fresh.measured_deg))
    if not target.absolute:
        corrected = told["slope"] * corrected - np.radians(told["zero_deg"])
    error = np.degrees(wrap(corrected - np.radians(fresh.reference_deg)))
    assert np.sqrt(np.mean(error**2)) < limit
    assert told["entries"] == len(table) == target.entries
    assert undescribed(told) == set()


def test_the_file_says_where_it_comes_from_and_is_the_same_again(folder: Path) -> None:
    made = []
    for _ in range(2):
        halltwin(
            "export", folder / "sweep.csv", "--for", "lut:8", "--seed", "3", "--json", folder / "same.json", "--force"
        )
        made.append((folder / "same.json").read_bytes())
    assert made[0] == made[1]
    halltwin("export", folder / "sensor.toml", "--for", "simplefoc", "-o", folder / "said.h", "--seed", "3")
    said = " ".join((folder / "said.h").read_text(encoding="utf-8").replace(" * ", " ").split())
    for words in (
        "Made by halltwin",
        "from sensor.toml, seed 3",
        "--for simplefoc",
        "Angle error on a sweep simulated",
    ):
        assert words in said
    assert "Not removed: noise: 0.0" in said


def test_of_a_twin_tells_what_no_table_removes(folder: Path) -> None:
    told = answer(folder, folder / "rich.toml", "--for", "c")
    left = {one["what"]: one for one in told["not_removed"]}
    assert {what: one["causes"] for what, one in left.items()} == {
        "noise": ["noise"],
        "direction": ["hysteresis"],
        "speed": ["latency"],
        "temperature": ["offset_drift"],
        "steps of the word": ["output_quantisation"],
    }
    # A lag is half of what the directions differ by; its sine over the turn is none.
    assert left["direction"]["rms_deg"] == pytest.approx(0.118, rel=0.05)
    # 720 readings: 0.02 deg to one in sqrt(1440), four times over.
    assert left["noise"]["rms_deg"] == pytest.approx(NOISE_DEG, rel=0.11)
    # 10 K x 0.004 % of the amplitude, in radians at most.
    assert left["temperature"]["largest_deg"] == pytest.approx(np.degrees(10 * 0.004e-2), rel=0.05)
    assert left["steps of the word"]["rms_deg"] == pytest.approx(360 / 4096 / np.sqrt(12), rel=0.05)
    # 20 us at 1000 rpm.
    assert left["speed"]["rms_deg"] == pytest.approx(0.12, rel=0.01)
    assert left["speed"]["at"] == "at 1000 rpm"
    assert undescribed(told) == set()


def test_a_twin_is_judged_on_a_sweep_simulated_from_it(folder: Path) -> None:
    (judged,) = answer(folder, folder / "sensor.toml", "--for", "lut:32")["judged"]
    assert judged["on"] == "on a sweep simulated from it"
    assert judged["rms_deg_after"] < 1.1 * NOISE_DEG < 0.3 < judged["rms_deg_before"]


def test_direction_of_a_sweep_is_told_apart_from_its_noise(folder: Path) -> None:
    told = answer(folder, ROOT / "scenarios/data/bench_sweep.csv", "--for", "moteus")
    left = {one["what"]: one["rms_deg"] for one in told["not_removed"]}
    # The truth of the file: a lag of 0.118 deg, and noise of which 0.0248 deg is left with the causes known.
    assert left["direction"] == pytest.approx(0.118, abs=0.003)
    assert left["noise"] == pytest.approx(0.0248, abs=0.002)


def test_a_table_that_makes_the_error_larger_ends_with_1(folder: Path) -> None:
    good = halltwin("export", folder / "sensor.toml", "--for", "lut", "--check", folder / "fresh.csv")
    assert good.code == 0
    bad = halltwin(
        "export", folder / "other.toml", "--for", "lut", "--check", folder / "fresh.csv", "-o", folder / "bad.csv"
    )
    assert bad.code == 1
    assert "makes the error larger on fresh.csv" in bad.err
    assert (folder / "bad.csv").exists()


def test_a_table_is_made_for_one_temperature(folder: Path) -> None:
    """At 85 C the offset is 60 K x 0.004 % more than at 25 C: 0.14 deg."""
    zero, sweep = (folder / name for name in ("at.csv", "warm.csv"))
    chain = Chain().with_effect("offset", y_percent=1.0).with_effect("offset_drift", x_percent_per_K=0.004)
    write_twin(folder / "drift.toml", chain)
    way = TAU * np.arange(360) / 180
    chain.simulate(Motion.from_angle(way, temperature_c=np.full(360, 85.0))).write(sweep)
    after = []
    for temperature in ("25", "85"):
        told = answer(
            folder, folder / "drift.toml", "--for", "lut", "--temperature", temperature, "--check", sweep, "-o", zero
        )
        after.append(told["judged"][0]["largest_deg_after"])
    assert after[0] == pytest.approx(np.degrees(60 * 0.004e-2), rel=0.02)
    assert after[1] < 1e-3


def test_of_sweeps_at_two_temperatures_a_table_is_made_for_one(folder: Path) -> None:
    """The drift found between them, and what it leaves at the other one told."""
    chain = Chain().with_effect("offset", y_percent=1.0).with_effect("offset_drift", x_percent_per_K=0.004)
    chain = chain.with_effect("noise", rms_deg=0.005)
    way = TAU * np.arange(360) / 180
    for number, (name, temperature) in enumerate({"cold": 25.0, "hot": 85.0, "hot_again": 85.0}.items()):
        motion = Motion.from_angle(way + 0.003 * number, temperature_c=np.full(360, temperature))
        chain.simulate(motion, seed=number).write(folder / f"{name}.csv")
    sweeps, rest = (folder / "cold.csv", folder / "hot.csv"), ("--for", "lut", "--check", folder / "hot_again.csv")
    told = answer(folder, *sweeps, *rest, "--temperature", "85")
    assert told["judged"][0]["rms_deg_after"] < 1.1 * 0.005
    left = {one["what"]: one["largest_deg"] for one in told["not_removed"]}
    assert left["temperature"] == pytest.approx(np.degrees(60 * 0.004e-2), rel=0.05)
    told = answer(folder, *sweeps, *rest)
    assert told["judged"][0]["largest_deg_after"] > 0.1


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--for", "odrive"), "ODrive takes no table"),
        (("--for", "vesc"), "VESC takes no table"),
        (("--for", "lut", "--least", "most"), "--least is 'most'; expected worst or rms"),
        (("--for", "lut", "--temperature", "999"), "temperature"),
        (("--for", "klipper", "-o", "table.h"), "such tables end in .cfg"),
        (("--for", "c", "-o", "table.csv"), "C headers end in .h"),
        (("--for", "c", "--name", "3d", "-o", "table.h"), "begins no C name"),
        (("--for", "klipper", "--name", "a]b", "-o", "table.cfg"), "names no section of printer.cfg"),
    ],
    ids=lambda one: " ".join(one) if isinstance(one, tuple) else "",
)
def test_what_cannot_be_is_refused(
    arguments: tuple[str, ...], said: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    ended = halltwin("export", folder / "sensor.toml", *arguments)
    assert ended.code == 2
    assert said in ended.err
    assert list(tmp_path.iterdir()) == []


def test_a_section_of_klipper_is_no_c_name(folder: Path, tmp_path: Path) -> None:
    """Its name may hold a hyphen, and begin with a digit."""
    path = tmp_path / "table.cfg"
    assert halltwin("export", folder / "sensor.toml", "--for", "klipper", "--name", "2nd-x", "-o", path).code == 0
    assert "[angle 2nd-x]" in path.read_text().splitlines()
