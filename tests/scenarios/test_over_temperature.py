"""compensate and diagnose over temperature, from the command line."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from diagnosis import diagnose
from tests.command_line import halltwin
from tests.diagnosis.thermal.devices import COLD_ROOM_HOT, each_at, over, steady, warm
from tests.test_nomenclature import undescribed
from twin.errors import UserError
from twin.files import write_twin
from twin.sweep import Sweep


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One sweep over three temperatures, the same as three sweeps, and one at a temperature between."""
    path = tmp_path_factory.mktemp("warm")
    warm().simulate(over(COLD_ROOM_HOT), seed=1).write(path / "steps.csv")
    for sweep, name in zip(each_at({c: warm() for c in COLD_ROOM_HOT}), ("a", "b", "c"), strict=True):
        sweep.write(path / f"one_{name}.csv")
    warm().simulate(over((0.0,), turns=1), seed=9).write(path / "between.csv")
    return path


def errors(out: str) -> dict[str, tuple[float, float]]:
    """RMS error [deg] before and after by what it is of."""
    found = re.findall(r"^ *(\S.*?) {2,}([\d.]+) -> ([\d.]+) ", out, re.M)
    return {name: (float(before), float(after)) for name, before, after in found}


def test_a_sweep_over_temperature_is_not_averaged(folder: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    files = {"toml": "c.toml", "table": "t.csv", "plot": "c.svg"}
    outputs = [part for kind, name in files.items() for part in (f"--{kind}", tmp_path / name)]
    ended = halltwin("compensate", folder / "steps.csv", *outputs)
    words = " ".join(ended.out.split())
    assert "sensitive: offset x, gain ratio; immune: offset y, phase, quadratic term, zero" in words
    told = errors(ended.out)
    for name in ("at -40.0 C", "at 25.0 C", "at 85.0 C", "at 25.0 C, made without it"):
        before, after = told[name]
        assert before > 0.3
        # Noise of 0.02 deg, and a correction of some fifteen figures from four fifths of 540 readings.
        assert after < 0.023
    content = tomllib.loads((tmp_path / "c.toml").read_text())
    assert content["factors"]["gain_ratio"] == "sensitive"
    assert (content["drift"]["low_c"], content["drift"]["high_c"]) == (-40.0, 85.0)
    assert "(64 points at 2 temperatures)" in ended.out
    assert np.genfromtxt(tmp_path / "t.csv", delimiter=",", names=True).size == 128
    picture = (tmp_path / "c.svg").read_text(encoding="utf-8")
    for words in ("offset x: sensitive", "phase: immune", "offset x [%]", "after, temperature held out", "noise floor"):
        assert words in picture


def test_several_sweeps_and_one_at_a_temperature_between(folder: Path) -> None:
    sweeps = sorted(folder.glob("one_*.csv"))
    ended = halltwin("compensate", *sweeps, "--check", folder / "between.csv")
    assert ended.code == 0
    assert "3 sweeps 540 readings; all fitted" in " ".join(ended.out.split())
    before, after = errors(ended.out)["on between.csv"]
    assert before > 0.35
    assert after < 0.023
    # A glob stands for the same.
    assert halltwin("compensate", f"{folder}/one_*.csv", "--check", folder / "between.csv").out == ended.out


def test_what_is_not_drawn_is_not_in_the_legend(folder: Path, tmp_path: Path) -> None:
    """Of two temperatures neither can be made without the other."""
    pytest.importorskip("matplotlib")
    two = sorted(folder.glob("one_*.csv"))[:2]
    assert halltwin("compensate", *two, "--plot", tmp_path / "two.svg").code == 0
    picture = (tmp_path / "two.svg").read_text(encoding="utf-8")
    assert "after, readings held out" in picture
    assert "temperature held out" not in picture


def test_a_correction_that_is_worse_at_one_temperature_is_not_hidden_in_the_mean(tmp_path: Path) -> None:
    """Made of a sensor without drift, tried on one whose gain runs away with the heat."""
    # At 85 C the drift undoes the mismatch: there the sensor is best without any correction.
    central = steady().with_effect("offset", x_percent=0.0, y_percent=0.0)
    central.with_effect("gain_drift", percent_per_K=-0.0165).simulate(over((25.0, 85.0)), seed=2).write(
        tmp_path / "warm.csv"
    )
    write_twin(tmp_path / "twin.toml", central.without("noise"))
    ended = halltwin("compensate", tmp_path / "twin.toml", "--check", tmp_path / "warm.csv")
    assert ended.code == 1
    assert "larger at 85.0 C" in ended.err
    assert "at 25.0 C" not in ended.err


def test_a_twin_is_corrected_over_a_span(folder: Path, tmp_path: Path) -> None:
    write_twin(tmp_path / "warm.toml", warm().without("noise"))
    at_one = halltwin("compensate", tmp_path / "warm.toml", "--check", folder / "steps.csv")
    assert "offset_drift, gain_drift: corrected as at 25 C" in at_one.out
    over_all = halltwin("compensate", tmp_path / "warm.toml", "--temperature=-40:85", "--check", folder / "steps.csv")
    assert "corrected as at" not in over_all.out
    # Without the drifts 0.1 deg are left at the ends; with them the noise alone.
    assert errors(at_one.out)["at 85.0 C"][1] > 0.08
    assert errors(over_all.out)["at 85.0 C"][1] < 0.021
    assert errors(over_all.out)["at -40.0 C"][1] < 0.021
    refused = halltwin("compensate", tmp_path / "warm.toml", "--temperature", "85:-40")
    assert refused.code == 2


def test_a_temperature_to_correct_for_is_refused_with_sweeps(folder: Path) -> None:
    refused = halltwin("compensate", folder / "between.csv", "--temperature", "25")
    assert refused.code == 2
    assert refused.err.startswith("halltwin: --temperature is for a twin, and these are sweeps; leave it out")


def test_a_long_gap_between_temperatures_is_said(folder: Path, tmp_path: Path) -> None:
    warm().simulate(over((-40.0, 85.0), turns=1), seed=9).write(tmp_path / "ends.csv")
    said = "no reading was taken between -40 and 85 C"
    assert said in " ".join(halltwin("diagnose", tmp_path / "ends.csv").out.split())
    assert "no reading was taken between" not in halltwin("diagnose", folder / "steps.csv").out


def test_what_is_corrected_to_the_middle_is_said() -> None:
    said = "corrected to the middle between both directions: hysteresis"
    assert said in " ".join(halltwin("compensate", "paper-encoder").out.split())


def test_one_temperature_is_said(folder: Path) -> None:
    assert "temperature 0.0 C alone" in halltwin("compensate", folder / "between.csv").out


@pytest.mark.parametrize(
    ("sources", "said"),
    [
        (("one_a.csv", "twin.toml"), "twin.toml is a twin beside other sources"),
        (
            ("one_a.csv", "bare.csv"),
            "bare.csv: several sweeps make one correction over temperature, and this",
        ),
        (("between.csv", "near.csv"), "2 sweeps hold temperatures within 5 K of each other"),
        (("one_a.csv", "turned.csv"), "turned.csv: its angle counts the other way round"),
    ],
)
def test_mistakes(folder: Path, sources: tuple[str, str], said: str) -> None:
    write_twin(folder / "twin.toml", warm())
    hot = Sweep.read(folder / "one_c.csv")
    columns = {"reference_deg": hot.reference_deg, "measured_deg": hot.measured_deg}
    Sweep.from_columns(columns).write(folder / "bare.csv")
    turned = {**columns, "measured_deg": -hot.measured_deg, "temperature_c": np.full(len(hot), 85.0)}
    Sweep.from_columns(turned).write(folder / "turned.csv")
    Sweep.from_columns({**columns, "temperature_c": np.full(len(hot), 3.0)}).write(folder / "near.csv")
    ended = halltwin("compensate", *(folder / name for name in sources))
    assert ended.code == 2
    assert said in ended.err
    assert len(ended.err.splitlines()) == 1


def test_diagnose_tells_the_laws(folder: Path, tmp_path: Path) -> None:
    ended = halltwin("diagnose", folder / "steps.csv", "--json", tmp_path / "d.json")
    assert "sensitive: offset x, gain ratio" in ended.out
    answer = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    law = answer["temperature"]["factors"]["Vx_over_Ax"]
    assert law["verdict"] == "sensitive"
    assert law["per_K"]["low"] < 4e-5 < law["per_K"]["high"]
    assert law["at_25"]["unit"] == "1"
    assert law["per_K"]["unit"] == "1/K"
    assert answer["temperature"]["factors"]["zero_deg"]["at_25"]["value"] == pytest.approx(37.0, abs=0.01)
    assert undescribed(answer) == set()
    halltwin("diagnose", folder / "between.csv", "--json", tmp_path / "one.json")
    assert json.loads((tmp_path / "one.json").read_text(encoding="utf-8"))["temperature"] is None


def test_picture_of_the_laws(folder: Path) -> None:
    pytest.importorskip("matplotlib")
    titles = [axis.get_title() for axis in diagnose(folder / "steps.csv").plot_over_temperature().axes]
    assert titles[:3] == ["offset x: sensitive", "offset y: immune", "gain ratio: sensitive"]
    with pytest.raises(UserError, match="nothing to draw over temperature"):
        diagnose(folder / "between.csv").plot_over_temperature()
