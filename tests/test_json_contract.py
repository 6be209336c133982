"""The JSON of ``halltwin explain`` (schema halltwin.explain/1), key by key."""

from __future__ import annotations

import itertools
import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from twin.catalogue import CATALOGUE, STAGES
from twin.files import from_dict, read_twin, to_dict

from .command_line import csv_text, explained, halltwin
from .hidden.generator import draw
from .test_nomenclature import undescribed

ROOT = Path(__file__).parents[1]
SWEEPS: dict[str, tuple[list[str], str | None, int]] = {
    "clean": ([], None, 11),
    "one cause": (["saturation"], None, 12),
    "unnamed": ([], "order_9_to_19", 13),
    "glitch": (["bus_glitch"], None, 14),
    "both directions": (["hysteresis"], None, 15),
    "oven": (["offset_drift"], None, 16),
}
BASELINE = {"Vx_over_Ax": "1", "Vy_over_Ay": "1", "gain_ratio": "1", "beta_deg": "deg", "quad": "1", "zero_deg": "deg"}
KINDS = {
    "order",
    "time_frequency",
    "step",
    "drift",
    "creep",
    "temperature",
    "direction",
    "speed",
    "local",
    "flanks",
    "seam",
    "code",
    "noise",
}
VERDICTS = {(False, False): "adequate", (True, False): "explained", (False, True): "unnamed"}
NAMES = {e.name for e in CATALOGUE if not e.baseline and not e.name.startswith("unnamed")}


def written(folder: Path, case: str) -> Path:
    """The case's sweep as a file."""
    causes, structure, seed = SWEEPS[case]
    path = folder / f"{case.replace(' ', '_')}.csv"
    draw(causes, seed=seed, structure=structure).write_csv(path)
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("contract")


@cache
def answered(folder: Path, case: str) -> dict[str, Any]:
    """The case's answer, asked for once; its extended twin stands beside it."""
    path = written(folder, case)
    return explained(path, "--extended", path.with_suffix(".toml"))


@pytest.fixture(params=SWEEPS)
def answer(request: pytest.FixtureRequest, folder: Path) -> dict[str, Any]:
    return answered(folder, request.param)


def is_figure(value: Any, *, low: float = -np.inf) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and bool(np.isfinite(value)) and value >= low


def check_parameter(entry: dict[str, Any]) -> None:
    """A parameter: a value, inside its interval where that is known, and a unit."""
    assert {"value", "low", "high", "unit"} <= set(entry)
    assert is_figure(entry["value"])
    assert isinstance(entry["unit"], str)
    assert entry["unit"]
    if entry["low"] is not None:
        assert is_figure(entry["low"])
        assert entry["low"] <= entry["value"]
    if entry["high"] is not None:
        assert is_figure(entry["high"])
        assert entry["high"] >= entry["value"]


def test_top_level(answer: dict[str, Any]) -> None:
    assert answer["schema"] == "halltwin.explain/1"
    assert {
        "sweep",
        "baseline",
        "noise_floor_deg",
        "verdict",
        "causes",
        "unexplained",
        "extended",
        "twin",
    } <= set(answer)
    assert is_figure(answer["noise_floor_deg"], low=0.0)


@pytest.mark.parametrize("case", SWEEPS)
def test_sweep(case: str, folder: Path) -> None:
    causes, structure, seed = SWEEPS[case]
    hidden = draw(causes, seed=seed, structure=structure)
    sweep = answered(folder, case)["sweep"]
    assert sweep["rows"] == hidden.truth["rows"]
    assert sweep["rows"] == sweep["used"] + sweep["rejected"]
    assert all(isinstance(sweep[key], int) for key in ("rows", "used", "rejected"))
    assert sweep["turns"] == pytest.approx(hidden.truth["turns"], rel=0.02, abs=0.02)
    assert sorted(sweep["columns"]) == sorted(hidden.columns)


def test_keys_stand_in_the_nomenclature(answer: dict[str, Any]) -> None:
    assert undescribed(answer) == set()


def test_baseline(answer: dict[str, Any]) -> None:
    baseline = answer["baseline"]
    assert set(baseline["parameters"]) >= set(BASELINE)
    for name, unit in BASELINE.items():
        entry = baseline["parameters"][name]
        check_parameter(entry)
        assert entry["unit"] == unit
        assert isinstance(entry["at_bound"], bool)
    assert is_figure(baseline["rms_deg"], low=0.0)
    assert is_figure(baseline["heldout_rms_deg"], low=0.0)


def test_causes(answer: dict[str, Any]) -> None:
    for cause in answer["causes"]:
        assert cause["name"] in NAMES | {"unnamed"}
        assert cause["stage"] in STAGES
        for entry in cause["parameters"].values():
            check_parameter(entry)
        assert 0.0 <= cause["false_alarm_probability"] < 0.01
        assert is_figure(cause["heldout_rms_deg_before"], low=0.0)
        assert is_figure(cause["heldout_rms_deg_after"], low=0.0)
        # What mechanics may do stands for itself: no effect, and so no simulated measurement, is made of it.
        alike = set(cause["indistinguishable_from"])
        assert alike <= NAMES | {"unnamed", "mechanics"}
        assert cause["name"] not in cause["indistinguishable_from"]
        assert isinstance(cause["to_tell_apart"], str)
        assert bool(cause["to_tell_apart"]) == bool(cause["indistinguishable_from"])
        offered = cause["to_tell_apart_options"]
        assert bool(offered) == bool(alike - {"mechanics"})
        assert [option["cost"] for option in offered] == sorted(option["cost"] for option in offered)
        for option in offered:
            assert is_figure(option["sigma"], low=0.0)
            assert option["measurement"]


def test_each_name_stands_once_and_the_strongest_first(answer: dict[str, Any]) -> None:
    names = [cause["name"] for cause in answer["causes"]]
    assert len(set(names)) == len(names)
    gains = [c["heldout_rms_deg_before"] ** 2 - c["heldout_rms_deg_after"] ** 2 for c in answer["causes"]]
    by_mean = [gain for gain, name in zip(gains, names, strict=True) if name not in ("bus_glitch", "stale_frames")]
    assert all(earlier >= later - 1e-6 for earlier, later in itertools.pairwise(by_mean))


def test_verdict_agrees_with_the_causes(answer: dict[str, Any]) -> None:
    names = {cause["name"] for cause in answer["causes"]}
    kinds = (bool(names - {"unnamed"}), "unnamed" in names)
    assert answer["verdict"] == VERDICTS.get(kinds, "partly explained")
    assert bool(answer["unexplained"]["structure"]) == ("unnamed" in names)


def test_structure(answer: dict[str, Any]) -> None:
    assert is_figure(answer["unexplained"]["rms_deg"], low=0.0)
    for entry in answer["unexplained"]["structure"]:
        assert entry["kind"] in KINDS
        assert len(entry) > 1
        assert all(is_figure(value) for key, value in entry.items() if key != "kind" and not isinstance(value, str))


def test_extended(answer: dict[str, Any]) -> None:
    extended = answer["extended"]
    assert is_figure(extended["rms_deg"], low=0.0)
    assert is_figure(extended["heldout_rms_deg"], low=0.0)
    before = answer["baseline"]["heldout_rms_deg"]
    assert extended["gain"] == pytest.approx(before / extended["heldout_rms_deg"], rel=1e-4)
    if not answer["causes"]:
        assert extended["gain"] == pytest.approx(1.0, rel=1e-6)
    if extended["likeness_p"] is not None:
        assert 0.0 < extended["likeness_p"] <= 1.0
        assert extended["likeness_worst"]


@pytest.mark.parametrize("case", SWEEPS)
def test_twin_is_the_content_of_the_extended_file(case: str, folder: Path) -> None:
    answer = answered(folder, case)
    chain = read_twin(folder / f"{case.replace(' ', '_')}.toml")
    assert to_dict(from_dict(answer["twin"])).keys() == to_dict(chain).keys()
    told, kept = answer["twin"]["effects"], to_dict(chain)["effects"]
    assert told.keys() == kept.keys()
    for name, params in told.items():
        assert params.keys() == kept[name].keys()
        for key, value in params.items():
            assert np.allclose(value, kept[name][key], rtol=1e-6), (name, key)


@pytest.mark.parametrize("case", SWEEPS)
def test_what_was_put_in_is_named(case: str, folder: Path) -> None:
    causes, structure, _ = SWEEPS[case]
    answer = answered(folder, case)
    assert [cause["name"] for cause in answer["causes"]] == [*causes, *(["unnamed"] if structure else [])]


def test_glitched_rows_are_counted_and_left_out(folder: Path) -> None:
    causes, structure, seed = SWEEPS["glitch"]
    truth = draw(causes, seed=seed, structure=structure).truth
    answer = answered(folder, "glitch")
    assert answer["sweep"]["rejected"] == 0
    assert answer["causes"][0]["parameters"]["count"]["value"] >= 1
    # Either figure leaves out the glitched rows: what stays is the bench's noise.
    assert answer["extended"]["rms_deg"] < 1.3 * truth["floor_deg"]
    assert answer["baseline"]["rms_deg"] < 1.3 * truth["floor_deg"]


def test_extended_twin_explains_its_own_sweep(folder: Path) -> None:
    """Out as TOML and in again: the same twin, and nothing left for it to learn."""
    answer = answered(folder, "one cause")
    again = explained(folder / "one_cause.csv", "--twin", folder / "one_cause.toml")
    assert again["verdict"] == "adequate"
    assert again["baseline"]["rms_deg"] == pytest.approx(answer["extended"]["rms_deg"], rel=1e-3)
    assert again["twin"]["effects"]["saturation"] == answer["twin"]["effects"]["saturation"]


def test_wrong_twin_is_found_out(folder: Path) -> None:
    """A twin that rounds as the sensor does, but lacks all its errors, cannot be adequate."""
    path = written(folder, "one cause")
    lacking = folder / "lacking.toml"
    lacking.write_text('schema = "halltwin.twin/1"\n[effects.output_quantisation]\nbits = 14\n', encoding="utf-8")
    answer = explained(path, "--twin", lacking)
    assert answer["baseline"]["rms_deg"] > 0.2
    assert answer["verdict"] != "adequate"


def test_same_input_and_seed_give_the_same_bytes(folder: Path) -> None:
    """In processes of their own, with hash seeds of their own."""
    path = written(folder, "one cause")
    outputs = []
    for number in ("1", "2"):
        (folder / number).mkdir()
        names = [folder / number / f"bytes.{ending}" for ending in ("json", "toml")]
        command = [sys.executable, "-m", "scenarios.cli.main", "explain", str(path), "--seed", "3"]
        command += ["--json", names[0].name, "--extended", names[1].name]
        environment = {**os.environ, "PYTHONHASHSEED": number, "PYTHONPATH": str(ROOT)}
        ended = subprocess.run(command, cwd=folder / number, env=environment, capture_output=True, check=True)
        outputs.append((ended.stdout, *(name.read_bytes() for name in names)))
    assert outputs[0] == outputs[1]


def test_file_is_plain_json_and_ends_with_a_line_end(folder: Path) -> None:
    answered(folder, "clean")
    content = (folder / "clean.csv.answer.json").read_text(encoding="utf-8")
    assert content.endswith("}\n")
    assert json.loads(content)["schema"] == "halltwin.explain/1"


def test_null_stands_where_nothing_can_be_known(tmp_path: Path) -> None:
    """Eighteen readings are too few to liken simulated sweeps to; null says so, and the command still ends well."""
    angles = np.arange(18) * 5.0
    path = tmp_path / "quarter.csv"
    path.write_text(csv_text({"reference_deg": angles, "measured_deg": angles + 3.0 + 0.01 * angles % 0.05}))
    answer = explained(path)
    assert answer["extended"]["likeness_p"] is None
    assert answer["extended"]["likeness_worst"] is None
    assert is_figure(answer["baseline"]["rms_deg"], low=0.0)


def test_where_nothing_can_be_known_there_is_no_answer(tmp_path: Path) -> None:
    """Eight readings could show nothing; a turn of sixteen is answered with every figure."""
    for count in (8, 16):
        angles = np.arange(count) * 360.0 / count
        path = tmp_path / f"{count}.csv"
        error = 0.2 * np.random.default_rng(count).standard_normal(count)
        path.write_text(csv_text({"reference_deg": angles, "measured_deg": angles + 3.0 + error}))
    refused = halltwin("explain", tmp_path / "8.csv", "--json", tmp_path / "8.json")
    assert refused.code == 2
    assert "8 readings; expected at least 16" in refused.err
    assert not (tmp_path / "8.json").exists()
    assert is_figure(explained(tmp_path / "16.csv")["baseline"]["heldout_rms_deg"], low=0.0)


def test_without_json_nothing_is_written(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(folder, "clean")
    monkeypatch.chdir(tmp_path)
    assert halltwin("explain", path).code == 0
    assert list(tmp_path.iterdir()) == []
