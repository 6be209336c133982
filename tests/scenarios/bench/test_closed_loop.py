"""Measure, explain, compensate, measure again: one run."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.report.provenance import day, version
from scenarios.bench.closed_loop import _temperature_c
from scenarios.bench.command import DEFAULT_TWIN, Options, run
from twin.angles import wrap_deg
from twin.chain import Chain
from twin.errors import UserError
from twin.presets import read_preset
from twin.sweep import Sweep


def test_a_loop_broken_off_in_its_second_half_goes_on_there(tmp_path: Path) -> None:
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    for folder in (whole, broken):
        folder.mkdir()
    # The first half takes 98 frames of the encoder, the loading one for each number, the second half one a reading: too
    # few are left for the run that goes on to fall silent again.
    options = Options(output=whole / "loop.csv", closed_loop=True, points=24, timeout_s=0.1)
    run(options)
    cut = replace(options, output=broken / "loop.csv", faults=["gone:hall=140"])
    with pytest.raises(UserError, match=r"Hall encoder .*did not answer|Hall encoder did not answer"):
        run(replace(cut, attempts=5))
    first = (broken / "loop-before.csv").read_bytes()
    assert (broken / "loop-after.csv.journal.jsonl").exists()
    run(cut)
    assert (broken / "loop-before.csv").read_bytes() == first == (whole / "loop-before.csv").read_bytes()
    assert (broken / "loop-correction.toml").read_bytes() == (whole / "loop-correction.toml").read_bytes()
    assert len(Sweep.read(broken / "loop-after.csv")) == 48
    # As if it had been killed when its second journal was a log already, and its first was not yet.
    log = broken / "loop-before.csv.log.jsonl"
    log.rename(broken / "loop-before.csv.journal.jsonl")
    run(cut)
    assert log.exists()
    log.rename(broken / "loop-before.csv.journal.jsonl")
    (broken / "loop-after.csv").write_text("somebody's own")
    with pytest.raises(UserError, match=r"loop-after\.csv: is there already"):
        run(cut)


def test_the_encoder_is_corrected_for_the_temperature_of_its_readings() -> None:
    drifting = Chain().with_effect("offset_drift", x_percent_per_K=0.01)
    for temps, told in (([60.0, 60.0], 0), ([20.0, 100.0], 1), ([None, None], 0)):
        kept = [SimpleNamespace(temperature_c=one) for one in temps]
        measured, said = SimpleNamespace(pretreated=SimpleNamespace(kept=kept)), []
        assert _temperature_c(measured, drifting, said.append) == (25.0 if temps[0] is None else 60.0)
        assert len(said) == told


def test_the_closed_loop_names_the_hidden_effect_and_corrects_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "saturation" not in read_preset(DEFAULT_TWIN).values
    pytest.importorskip("matplotlib")
    picture = tmp_path / "loop.png"
    asked = {"seed": 1, "fail_on": ["missed"], "command": "halltwin bench --closed-loop --points 120 --seed 1"}
    run(Options(output=tmp_path / "loop.csv", closed_loop=True, points=120, plot=picture, **asked))
    report = json.loads((tmp_path / "loop-report.json").read_text())
    assert [report[key] for key in ("version", "date", "seed", "command")] == [version(), day(), 1, asked["command"]]
    assert "saturation" in [cause["name"] for cause in report["causes"]]
    assert report["before"]["largest_deg"] > 0.8
    assert report["after"]["largest_deg"] < 0.2
    assert report["reached"]
    after = Sweep.read(tmp_path / "loop-after.csv")
    assert np.max(np.abs(wrap_deg(after.measured_deg - after.reference_deg))) < 0.2
    # The corrected angle is not computed from the channels alone, so they are not recorded beside it.
    assert after.vx is None
    assert len(after) == 240
    assert picture.stat().st_size > 10_000
    assert "reached" in capsys.readouterr().out
    assert (tmp_path / "loop-twin.toml").exists()
    assert (tmp_path / "loop-correction.toml").exists()
