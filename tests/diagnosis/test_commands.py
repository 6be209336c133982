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
    angle = TAU * np.arange(180) / 180
    rng = np.random.default_rng(0)
    for name, field in (("near", 1.0), ("far", 0.6)):
        # A misalignment grows as the sensor comes nearer; the channels are in volts.
        chain = device(1.0 + 0.01 * field)
        clean = chain.channels(Motion.from_angle(angle))
        x, y = clean * field
        measured = np.degrees(np.arctan2(y, x)) + 0.01 * rng.standard_normal(180)
        columns = {"reference_deg": np.degrees(angle), "measured_deg": measured, "vx": x, "vy": y}
        Sweep.from_columns(columns).write(tmp_path / f"{name}.csv")
    diagnose.run(SweepFiles([str(tmp_path)]), outputs=diagnose.Outputs(json=tmp_path / "a.json"))
    assert "air gaps: gain ratio and phase change" in capsys.readouterr().out
    laws = {law["part"]: law["best"] for law in json.loads((tmp_path / "a.json").read_text())["air_gaps"]}
    assert laws["gain mismatch and phase"] == "grows with the field"
    assert laws["quadratic term"] == "stays"


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
    compensate.run(folder / "sweep00.csv", outputs=outputs)
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
        tmp_path / "twin.toml", outputs=compensate.Outputs(), check=SweepFiles([str(folder / "sweep01.csv")])
    )
    line = next(text for text in capsys.readouterr().out.splitlines() if text.startswith("on sweep01.csv"))
    before, after = (float(line.split()[place]) for place in (2, 4))
    assert before > 0.3
    assert after < 0.03


def test_compensate_mistakes(folder: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    with pytest.raises(UserError, match="points is 1"):
        compensate.run(folder / "sweep00.csv", outputs=compensate.Outputs(points=1))
    write_twin(tmp_path / "twin.toml", device())
    with pytest.raises(UserError, match="nothing to draw"):
        compensate.run(tmp_path / "twin.toml", outputs=compensate.Outputs(plot=tmp_path / "p.png"))


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
