"""halltwin diagnose, compensate and monitor from the command line, and what they say to mistakes."""

from __future__ import annotations

import csv
import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from scenarios.commands import compensate, diagnose, monitor
from scenarios.commands.inputs import SweepFiles, sweep_paths
from scenarios.commands.known import Known
from tests.diagnosis.factors.gap_sweeps import Truth
from twin.angles import TAU
from twin.chain import Chain
from twin.errors import UserError
from twin.files import write_twin
from twin.motion import Motion
from twin.sweep import Sweep


def device(ratio: float = 1.01) -> Chain:
    return (
        Chain()
        .with_effect("offset", x_percent=0.8, y_percent=-0.5)
        .with_effect("gain_mismatch", ratio=ratio)
        .with_effect("quadratic_nonlinearity", q_percent=0.2)
        .with_effect("noise", rms_deg=0.02)
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twenty-four sweeps of one device whose gain begins to drift after the twelfth."""
    path = tmp_path_factory.mktemp("series")
    motion = Motion.from_angle(TAU * np.arange(72) / 72)
    for k in range(24):
        device(1.01 + 2e-4 * max(k - 12, 0)).simulate(motion, seed=k).write(path / f"sweep{k:02d}.csv")
    return path


def test_diagnose_one(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target, picture, other = tmp_path / "a.json", tmp_path / "a.png", tmp_path / "b.svg"
    pytest.importorskip("matplotlib")
    outputs = diagnose.Outputs(json=target, plot=picture, convergence=other)
    diagnose.run(SweepFiles([str(folder / "sweep00.csv")]), outputs=outputs)
    shown = capsys.readouterr().out
    assert "gain ratio" in shown
    assert "would look the same" in shown
    content = json.loads(target.read_text())
    assert content["schema"] == "halltwin.diagnose/1"
    (sweep,) = content["sweeps"]
    gain = sweep["parameters"]["gain_ratio"]
    assert gain["low"] < 1.01 < gain["high"]
    assert picture.stat().st_size > 10_000
    assert other.read_text().startswith("<?xml")


def test_diagnose_many_and_twice_the_same_bytes(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("a.json", "b.json"):
        diagnose.run(SweepFiles([str(folder)]), outputs=diagnose.Outputs(json=tmp_path / name), seed=3)
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()
    assert len(json.loads((tmp_path / "a.json").read_text())["sweeps"]) == 24
    assert "sweep23.csv" in capsys.readouterr().out


def test_diagnose_uses_several_air_gaps(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The truth: a sensor 0.67 mm off the axis of this magnet, whose first gap of 1 mm is stated."""
    folder = tmp_path / "gaps"
    folder.mkdir()
    rng = np.random.default_rng(5)
    for gap in (1.0, 2.0, 3.0):
        columns = Truth(sensor=0.6 + 0.3j).sweep(gap, rng)
        Sweep.from_columns(columns).write(folder / f"gap{gap:.0f}.csv")
    answer = tmp_path / "a.json"
    known = Known(magnet="shape=cylinder,diameter_mm=6,height_mm=2.5", air_gap="1")
    diagnose.run(SweepFiles([str(folder)]), outputs=diagnose.Outputs(json=answer), known=known)
    shown = " ".join(capsys.readouterr().out.split())
    content = json.loads(answer.read_text())
    found = content["air_gap_fit"]
    assert found["fits"] is True
    assert found["named"] == ["sensor"]
    off = found["sensor_off_axis"]
    assert off["low_mm"] < abs(0.6 + 0.3j) < off["high_mm"]
    assert found["gaps_mm"] == pytest.approx([1.0, 2.0, 3.0], abs=0.05)
    for sentence in found["sentences"]:
        assert " ".join(sentence.split()) in shown
    laws = {law["part"]: law["best"] for law in content["air_gaps"]}
    assert laws["gain mismatch and phase"] == "follows the field off the axis"
    # Each sweep's own equivalent is counted at its own gap, which the amplitudes tell.
    for sweep, gap in zip(content["sweeps"], (1.0, 2.0, 3.0), strict=True):
        own = sweep["mechanical"]
        assert own["air_gap_mm"] == pytest.approx(gap, abs=0.05)
        assert own["off_axis_low_mm"] < abs(0.6 + 0.3j) < own["off_axis_high_mm"]


@pytest.mark.parametrize(
    ("known", "said"),
    [
        (Known(magnet="diameter=6"), "magnet has no 'diameter'"),
        (Known(magnet=""), "magnet is ''; expected NAME=VALUE"),
        (Known(magnet="diameter_mm"), "magnet has 'diameter_mm'; expected NAME=VALUE"),
        (Known(air_gap="1,x"), "air_gap is '1,x'; expected numbers"),
        (Known(air_gap=","), "found no air gap"),
        (Known(air_gap="1,2,3"), "found 3 air gaps for 1 sweep"),
        (Known(air_gap="-1"), "air_gap_mm is -1 mm; expected from"),
        (Known(air_gap="1", air_gap_error_mm=2.0), "gap_error_mm is 2 mm"),
        (Known(twin="no-such-preset"), "no-such-preset"),
    ],
)
def test_what_is_known_is_checked(folder: Path, known: Known, said: str) -> None:
    with pytest.raises(UserError, match=said):
        diagnose.run(SweepFiles([str(folder / "sweep00.csv")]), known=known)


def test_inputs(folder: Path, tmp_path: Path) -> None:
    assert len(sweep_paths([str(folder / "*0.csv")])) == 3
    assert sweep_paths([str(folder)])[0].name == "sweep00.csv"
    with pytest.raises(UserError, match="no such file"):
        sweep_paths(["nowhere/*.csv"])
    with pytest.raises(UserError, match="no sweep in this folder"):
        sweep_paths([str(tmp_path)])


def test_compensate_a_sweep(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    outputs = compensate.Outputs(
        header=tmp_path / "c.h", table=tmp_path / "t.csv", points=32, toml=tmp_path / "c.toml", plot=tmp_path / "p.png"
    )
    compensate.run([folder / "sweep00.csv"], outputs=outputs)
    shown = capsys.readouterr().out
    assert "on held-out blocks" in shown
    assert "halltwin_correct" in (tmp_path / "c.h").read_text()
    with (tmp_path / "t.csv").open() as file:
        assert len(list(csv.DictReader(line for line in file if not line.startswith("#")))) == 32
    assert tomllib.loads((tmp_path / "c.toml").read_text())["slope"] == 1
    assert (tmp_path / "p.png").stat().st_size > 10_000


def test_compensate_a_twin_on_another_sweep(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_twin(tmp_path / "twin.toml", device())
    compensate.run(
        [tmp_path / "twin.toml"], outputs=compensate.Outputs(), check=SweepFiles([str(folder / "sweep01.csv")])
    )
    line = next(text for text in capsys.readouterr().out.splitlines() if text.startswith("on sweep01.csv"))
    before, after = (float(line.split()[place]) for place in (2, 4))
    assert before > 0.3
    assert after < 0.03


def test_compensate_mistakes(folder: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    with pytest.raises(UserError, match="points is 1"):
        compensate.run([folder / "sweep00.csv"], outputs=compensate.Outputs(points=1))
    write_twin(tmp_path / "twin.toml", device())
    with pytest.raises(UserError, match="nothing to draw"):
        compensate.run([tmp_path / "twin.toml"], outputs=compensate.Outputs(plot=tmp_path / "p.png"))


def test_monitor_names_the_factor_that_drifts(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    monitor.run(SweepFiles([str(folder)]), json_path=tmp_path / "m.json", plot=tmp_path / "m.png")
    assert "gain ratio drifts up" in capsys.readouterr().out
    first = json.loads((tmp_path / "m.json").read_text())["first"]
    assert first["factor"] == "gain_ratio"
    told = json.loads((tmp_path / "m.json").read_text())["factors"]["gain_ratio"]
    # Twelve sweeps as they were, then a ramp: its start lies in the interval, and so does the estimate.
    assert told["change"]["kind"] == "ramp"
    assert told["change"]["low"] <= 14 <= told["change"]["high"]
    assert told["unit"] == "1"
    assert "forward" not in told
    assert 13 < first["number"] <= 22
    assert (tmp_path / "m.png").stat().st_size > 10_000


def test_monitor_takes_the_turns_of_one_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    angle = np.tile(TAU * np.arange(40) / 40, 8)
    turn = np.repeat(np.arange(8), 40)
    device().simulate(Motion.from_angle(angle, turn=turn), seed=0).write(tmp_path / "turns.csv")
    monitor.run(SweepFiles([str(tmp_path / "turns.csv")]))
    assert "8 sweeps" in capsys.readouterr().out


def test_monitor_mistakes(folder: Path) -> None:
    with pytest.raises(UserError, match="expected at least 5"):
        monitor.run(SweepFiles([str(folder / "sweep00.csv")]))
    with pytest.raises(UserError, match="run length"):
        monitor.run(SweepFiles([str(folder)]), run_length=2.0)


def test_the_same_readings_again_are_no_series(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Between identical files nothing scatters, so that the last digit would pass for a drift."""
    names = [str(folder / "sweep00.csv")] * 5
    with pytest.raises(UserError, match=r"sweep00\.csv and sweep00\.csv .* hold the same readings"):
        monitor.run(SweepFiles(names))
    diagnose.run(SweepFiles(names[:2]))
    assert "the same readings, not several measurements: sweep00.csv, sweep00.csv" in capsys.readouterr().out
