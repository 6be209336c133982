"""A sweep explained for the page: the command line's own answer, byte for byte, and its layers taken off and put on."""

from __future__ import annotations

import gzip
import inspect
import json
import os
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis import explain
from scenarios.cli.sweeps import explain as command
from scenarios.lab import sweeps
from scenarios.lab.columns import MOST_POINTS, drawn, extremes, highest_in_columns
from scenarios.lab.explaining import BUDGET_S, SEED, Explaining, Question
from scenarios.lab.layers import MODEL, Layers, Look
from scenarios.lab.told import told_of
from tests.command_line import csv_text, halltwin, sweep_angles
from tests.scenarios.lab.serving import Client
from twin.files import write_twin
from twin.presets import read_preset

NAME = "my sweep.csv"
TWIN = """schema = "halltwin.twin/1"
[effects.offset]
x_percent = 0.6
y_percent = -0.4
[effects.gain_mismatch]
ratio = 1.01
[effects.hysteresis]
lag_deg = 0.12
memory_deg = 8.0
[effects.noise]
rms_deg = 0.02
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep of a sensor with hysteresis, and its twin."""
    here = tmp_path_factory.mktemp("sweeps")
    (here / "twin.toml").write_text(TWIN)
    options = ("--points", "120", "--both-directions", "--no-channels", "--seed", "3")
    ended = halltwin("simulate", here / "twin.toml", "-o", here / NAME, *options)
    assert ended.code == 0, ended.err
    return here


def dropped(client: Client, sweep: Path, *, name: str | None = None) -> None:
    """Drop a sweep on the page."""
    got = client.ask("sweep/open", body=sweep.read_bytes(), X_File_Name=(name or sweep.name).replace(" ", "%20"))
    assert got.status == 200, got.content


def ended(client: Client, *, within_s: float = 120.0) -> dict[str, Any]:
    """How a search ended."""
    end = time.monotonic() + within_s
    while (stand := client.ask("explain").json)["state"] == "working":
        assert time.monotonic() < end, stand
        time.sleep(0.05)
    found: dict[str, Any] = stand
    return found


def explained(client: Client, *, held: bool = False) -> dict[str, Any]:
    """The answer to the sweep that was dropped."""
    assert client.ask("explain/begin", {"held": held}).json["state"] == "working"
    stand = ended(client)
    assert stand["state"] == "done", stand["words"]
    answer: dict[str, Any] = stand["answer"]
    return answer


@pytest.fixture(scope="module")
def answer(client: Client, folder: Path) -> dict[str, Any]:
    dropped(client, folder / NAME)
    return explained(client)


def look(client: Client, **changes: Any) -> dict[str, Any]:
    content = {"off": [], "values": {}, "over": "angle", "width": 300, "spectrum": False, **changes}
    told: dict[str, Any] = client.ask("explain/look", content).json
    return told


@pytest.mark.parametrize("held", [False, True])
def test_the_answer_is_the_command_lines_byte_for_byte(
    held: bool, client: Client, folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The command that the page shows writes the same JSON, extended twin and report."""
    monkeypatch.chdir(folder)
    dropped(client, folder / NAME)
    if held:
        client.ask("twin/open", body=(folder / "twin.toml").read_bytes(), X_File_Name="twin.toml")
    told = explained(client, held=held)
    client.ask("twin/preset", {"name": "imc-14bit"})
    words = ["explain", NAME, *(["--twin", "twin.toml"] if held else [])]
    assert told["command"] == " ".join(["halltwin", "explain", f"'{NAME}'", *words[2:], "--seed", "0"])
    files = {"answer.json": "--json", "extended.toml": "--extended", "report.html": "--report"}
    written = [word for name, option in files.items() for word in (option, tmp_path / name)]
    assert halltwin(*words, *written).code == 0
    for name in files:
        got = client.ask(f"explain/{name}")
        assert got.status == 200
        assert got.headers["Content-Disposition"] == f'attachment; filename="{name}"'
        assert got.content == (tmp_path / name).read_bytes()


def test_budget_and_seed_are_the_command_lines() -> None:
    defaults = {name: one.default for name, one in inspect.signature(command).parameters.items()}
    assert (defaults["budget"], defaults["seed"]) == (BUDGET_S, SEED)


@pytest.mark.parametrize("here", [Path(__file__).parents[3], Path(__file__).parent])
def test_the_example_is_named_so_that_a_command_finds_it(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(here)
    found = sweeps.example()
    assert found.name == "bench_sweep.csv"
    assert Path(found.shown).samefile(found.path)
    assert Path(found.shown).is_absolute() == (here == Path(__file__).parent)


def test_layers_are_what_the_answer_says(answer: dict[str, Any], client: Client, folder: Path) -> None:
    """On: what its twin leaves. Off: what a cause does, and with all off the error as it was measured."""
    assert [one["name"] for one in answer["layers"]] == [MODEL, "hysteresis"]
    saved = client.ask("explain/answer.json").json
    assert answer["all_deg"] == pytest.approx(saved["extended"]["fitted_rms_deg"], rel=1e-5)
    assert answer["measured_deg"] == pytest.approx(saved["baseline"]["fitted_error_rms_deg"], rel=1e-5)
    assert look(client)["rms_deg"] == pytest.approx(answer["all_deg"])
    without = look(client, off=["hysteresis"])
    assert without["rms_deg"] == pytest.approx(answer["layers"][1]["without_deg"])
    # Off, the two directions stand apart by twice the lag.
    ways = {way: np.mean(part["y"]) for way, part in without["ways"].items()}
    assert abs(ways["forward"] - ways["backward"]) == pytest.approx(2 * 0.12, abs=0.03)
    all_off = look(client, off=[MODEL, "hysteresis"])
    assert all_off["rms_deg"] == pytest.approx(answer["measured_deg"], rel=0.02)
    assert all_off["rms_deg"] > without["rms_deg"] > answer["all_deg"]
    points = {round(x, 4) for part in look(client)["ways"].values() for x in part["x"]}
    recorded = np.genfromtxt(folder / NAME, delimiter=",", names=True)["reference_deg"]
    assert points <= {round(float(x) % 360.0, 4) for x in recorded}


def test_a_number_that_is_moved_leaves_more(answer: dict[str, Any], client: Client) -> None:
    """By as much as it does: half a percent of offset is 0.29 deg at most, 0.2 deg RMS."""
    slider = next(one for one in answer["sliders"] if one["name"] == "offset.x_percent")
    assert slider["label"] == "offset x"
    assert slider["low"] < 0.0 < 0.6 < slider["high"]
    assert slider["value"] == pytest.approx(0.6, abs=3 * slider["half_width"])
    moved = look(client, values={"offset.x_percent": slider["value"] + 0.5})
    expected = np.hypot(answer["all_deg"], np.degrees(0.005) / np.sqrt(2.0))
    assert moved["rms_deg"] == pytest.approx(expected, rel=0.05)


def test_the_residual_is_drawn_over_what_the_sweep_holds(answer: dict[str, Any], client: Client) -> None:
    assert set(answer["across"]) == {"angle", "clock"}
    over_time = look(client, over="clock", spectrum=True)
    assert over_time["x"] == "time / s"
    assert over_time["span"][1] > 60.0
    assert over_time["spectrum"]["order"][0] == 0.0
    assert len(over_time["spectrum"]["noise_deg"]) == len(over_time["spectrum"]["order"])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"over": "luck"}, "over is 'luck'"),
        ({"off": ["luck"]}, "off has 'luck'"),
        ({"off": "hysteresis"}, "off is 'hysteresis'"),
        ({"values": {"luck.x": 1.0}}, "values has 'luck.x'"),
        ({"values": {"offset.x_percent": "1"}}, "values is"),
        ({"values": {"offset.x_percent": 1e9}}, "offset.x_percent must lie between"),
        ({"width": 1e9}, "width is"),
        ({"more": 1}, "a look is"),
    ],
)
def test_a_look_that_cannot_be_is_one_line(
    changes: dict[str, Any], said: str, answer: dict[str, Any], client: Client
) -> None:
    assert said in str(look(client, **changes)["error"])
    assert look(client)["rms_deg"] == pytest.approx(answer["all_deg"])


def test_what_to_measure_next_is_what_the_sweep_lacks(answer: dict[str, Any]) -> None:
    steps = {one["do"]: one["why"] for one in answer["next"]}
    assert "gain_drift" in steps["record temperature_c"]


HOSTILE = {
    "nothing": (b"", "empty"),
    "no table": (b"\x00\x01\x02" * 50, ""),
    "markup": (b"<script>alert(1)</script>\n" * 20, ""),
    "no numbers": (b"reference_deg,measured_deg\n" + b"=cmd(),<b>\n" * 30, ""),
    "nan alone": (b"reference_deg,measured_deg\n" + b"nan,nan\n" * 30, ""),
    "a bomb": (gzip.compress(b"0" * 3_000_000), ""),
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_a_hostile_sweep_is_one_line_that_names_it(kind: str, client: Client, tmp_path: Path) -> None:
    content, said = HOSTILE[kind]
    name = "evil.csv.gz" if kind == "a bomb" else "evil.csv"
    (tmp_path / name).write_bytes(content)
    dropped(client, tmp_path / name)
    assert client.ask("explain/begin", {"held": False}).status == 200
    stand = ended(client)
    assert stand["state"] == "failed"
    assert name in stand["words"]
    assert said in stand["words"]
    assert "\n" not in stand["words"]
    assert str(tmp_path) not in stand["words"]
    assert "sweep.csv" not in stand["words"]
    got = client.ask("explain/answer.json")
    assert got.status == 400
    assert "no sweep has been explained" in got.error


@pytest.mark.parametrize("name", ["../../evil.csv", "evil.toml", "evil.xlsx", "a\tb.csv"])
def test_a_hostile_name_of_a_sweep_is_refused(name: str, client: Client) -> None:
    got = client.ask("sweep/open", body=b"x", X_File_Name=name.replace("\t", "%09"))
    assert got.status == 400
    assert got.error


@pytest.fixture(scope="module")
def long_sweep(folder: Path) -> Path:
    """One whose search takes long enough to be stopped."""
    rng = np.random.default_rng(1)
    angle = np.concatenate([np.arange(0.0, 7200.0, 0.5), np.arange(7200.0, 0.0, -0.5)])
    reading = sweep_angles(angle, noise_deg=0.01, seed=2) + 0.05 * np.sin(np.radians(7.3 * angle))
    reading += 0.02 * np.cumsum(rng.standard_normal(angle.size)) / np.sqrt(angle.size)
    path = folder / "long.csv"
    path.write_text(csv_text({"reference_deg": angle, "measured_deg": reading % 360.0}))
    return path


def test_a_search_is_stopped_with_the_answer_so_far(client: Client, long_sweep: Path) -> None:
    dropped(client, long_sweep)
    client.ask("explain/begin", {"held": False})
    end = time.monotonic() + 60.0
    while "search" not in (stand := client.ask("explain").json)["words"]:
        assert stand["state"] == "working"
        assert time.monotonic() < end
        time.sleep(0.02)
    # What is computed is counted as the budget is: without the start of the process, and no waiting for the machine.
    assert 0.0 < stand["computed_s"] < stand["elapsed_s"]
    stand = client.ask("explain/stop", {}).json
    assert stand["state"] == "working"
    stand = ended(client)
    assert stand["state"] == "done", stand
    assert stand["answer"]["cut_short"]["by"] == "interrupt"
    assert "stopped before its end" in stand["answer"]["verdict_words"]


def test_a_second_stop_ends_it_at_once_and_a_new_search_begins(client: Client, long_sweep: Path, folder: Path) -> None:
    dropped(client, long_sweep)
    client.ask("explain/begin", {"held": False})
    client.ask("explain/stop", {})
    stand = client.ask("explain/stop", {}).json
    assert stand["state"] == "failed"
    dropped(client, folder / NAME)
    assert explained(client)["verdict"] == "explained"


def test_the_process_goes_with_the_session(folder: Path, tmp_path: Path) -> None:
    question = Question(sweep=folder / NAME, name=NAME, twin=None, command="", budget_s=60.0, seed=0, folder=tmp_path)
    search = Explaining()
    search.begin(question)
    assert search._process is not None
    number = search._process.pid
    assert number is not None
    search.close()
    with pytest.raises(ProcessLookupError):
        os.kill(number, 0)
    assert search.stand()["state"] in ("working", "failed")


def test_a_process_that_dies_is_told(client: Client, folder: Path) -> None:
    question = Question(sweep=folder / NAME, name=NAME, twin=None, command="", budget_s=60.0, seed=0, folder=folder)
    search = Explaining()
    search.begin(question)
    assert search._process is not None
    search._process.kill()
    search._process.join()
    stand = search.stand()
    assert stand["state"] == "failed"
    assert "ended without an answer" in stand["words"]
    search.close()


def test_a_twin_that_was_dropped_is_what_the_sweep_is_held_against(
    client: Client, folder: Path, tmp_path: Path
) -> None:
    """A twin with another offset: the change is told."""
    twin = read_preset("paper-encoder").with_effect("offset", x_percent=-1.0, y_percent=0.0)
    write_twin(tmp_path / "old.toml", twin)
    client.ask("twin/open", body=(tmp_path / "old.toml").read_bytes(), X_File_Name="old.toml")
    dropped(client, folder / NAME)
    told = explained(client, held=True)
    client.ask("twin/preset", {"name": "imc-14bit"})
    assert told["held_against"] == "given twin"
    assert "--twin old.toml" in told["command"]
    assert any("offset" in words for words in told["changed"])


def answer_layers(effects: str, *options: str, folder: Path) -> Layers:
    """The layers of a simulated sweep of a sensor with these effects."""
    (folder / "twin.toml").write_text(TWIN.partition("[effects.hysteresis]")[0] + effects)
    assert halltwin("simulate", folder / "twin.toml", "-o", folder / "s.csv", "--seed", "3", *options).code == 0
    return Layers(explain(folder / "s.csv"))


def test_single_readings_come_back_where_their_cause_is_off(tmp_path: Path) -> None:
    effects = "[effects.bus_glitch]\ncount = 5.0\n[effects.noise]\nrms_deg = 0.02\n"
    layers = answer_layers(effects, "--points", "120", "--turns", "2", folder=tmp_path)
    assert "bus_glitch" in layers.causes
    shown = {"values": {}, "over": "angle", "width": 300, "with_spectrum": False}
    on, off = (layers.look(Look(off=frozenset(names), **shown)) for names in ((), ("bus_glitch",)))
    assert on["rms_deg"] < 0.03
    assert "touched" not in on
    assert len(off["touched"]["y"]) == len(layers.causes["bus_glitch"].rows) >= 3
    assert off["rms_deg"] > 1.0


def test_all_off_is_the_error_as_measured_whatever_a_cause_does_to_the_zero(tmp_path: Path) -> None:
    """A slip of the reference moves the mean of all that follow."""
    effects = "[effects.index_slip]\nstep_deg = 0.9\ntime_s = 40.0\n[effects.noise]\nrms_deg = 0.02\n"
    layers = answer_layers(effects, "--points", "120", "--turns", "2", folder=tmp_path)
    told = layers.told()
    assert len(told["layers"]) > 1
    off = frozenset(one["name"] for one in told["layers"])
    look_ = Look(off=off, values={}, over="angle", width=300, with_spectrum=False)
    assert layers.look(look_)["rms_deg"] == pytest.approx(told["measured_deg"], rel=1e-3)


# ---- many readings -----------------------------------------------------------------------------------------------


def test_of_many_readings_each_column_keeps_its_extremes() -> None:
    rng = np.random.default_rng(0)
    x, y = rng.uniform(0.0, 360.0, 100_000), rng.standard_normal(100_000)
    y[777] = 9.0
    told = drawn(x, y, (0.0, 360.0), 800)
    assert len(told["x"]) == 800
    assert max(told["high"]) == 9.0
    column = int(x[777] / 0.45)
    inside = (x >= 0.45 * column) & (x < 0.45 * (column + 1))
    at, low, high = extremes(x, y, (0.0, 360.0), 800)
    assert (low[column], high[column]) == (y[inside].min(), y[inside].max())
    assert at[column] == pytest.approx(0.45 * (column + 0.5))
    few = drawn(x[:MOST_POINTS], y[:MOST_POINTS], (0.0, 360.0), 100)
    assert few["y"] == y[:MOST_POINTS].round(6).tolist()


def test_a_spectrum_keeps_its_lines() -> None:
    order = np.arange(100_000) / 100.0
    amplitude = np.full(order.size, 0.1)
    amplitude[31_337] = 2.0
    at, high, beside = highest_in_columns(order, amplitude, order * 2.0, 300)
    assert at.size <= 300
    assert high.max() == 2.0
    assert at[np.argmax(high)] == order[31_337]
    assert beside[np.argmax(high)] == 2.0 * order[31_337]
    assert np.all(np.diff(at) > 0.0)


def test_an_answer_is_plain_values(answer: dict[str, Any]) -> None:
    assert json.loads(json.dumps(answer, allow_nan=False)) == answer


def test_how_a_log_was_read_is_told(tmp_path: Path) -> None:
    """A guess of the reader is the user's to judge: the statement, what was taken for granted, what is not used."""
    reference = np.arange(0.0, 360.0, 2.0)
    measured = sweep_angles(reference)
    log, answer = tmp_path / "log.csv", tmp_path / "answer.json"
    columns = {"ref_deg": reference, "sensor_deg": measured, "temp": np.full(reference.size, 24.0), "junk": measured**2}
    log.write_text(csv_text(columns))
    assert halltwin("explain", log, "--json", answer).code == 0
    told = told_of(json.loads(answer.read_text()))["read_words"]
    assert told == (
        " Read as reference_deg=ref_deg, measured_deg=sensor_deg, temperature_c=temp; taken for granted: temp is taken "
        "in C; not used: junk."
    )
    own = csv_text({"reference_deg": reference, "measured_deg": measured})
    (tmp_path / "own.csv").write_text(own)
    assert halltwin("explain", tmp_path / "own.csv", "--json", answer, "--force").code == 0
    assert told_of(json.loads(answer.read_text()))["read_words"] == ""
