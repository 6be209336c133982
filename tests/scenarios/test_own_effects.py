"""Effects of one's own: written by the command, refused where they break the contract, and named like any other."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.command_line import explained, halltwin
from tests.hidden.gear_sweep import BACKWARD_DEG, FORWARD_DEG, PHASE_DEG
from tests.hidden.gear_sweep import main as make_gear_sweep
from tests.hidden.generator import draw

DATA = Path(__file__).parents[2] / "scenarios/data"
SWEEP, GEAR = DATA / "gear_sweep.csv", DATA / "gear_mesh.py"

STRUCTURES: dict[str, dict[str, Any]] = {
    "nothing": {},
    "order": {"kind": "order", "order": 12.9986, "amplitude_deg": 0.07, "phase_deg": 40.0},
    "order_between": {"kind": "order", "order": 0.731812, "amplitude_deg": 0.07, "phase_deg": 40.0},
    "direction": {"kind": "direction", "order": 3.0, "amplitude_deg": 0.05},
    "temperature": {"kind": "temperature", "order": 4.0, "amplitude_deg": 0.05},
    "temperature_zero": {"kind": "temperature", "order": 0.0, "amplitude_deg": 0.05},
    "speed": {"kind": "speed", "order": 2.0, "amplitude_deg": 0.1, "power": 1.0},
    "speed_squared": {"kind": "speed", "order": 0.0, "amplitude_deg": 0.1, "power": -2.0},
    "time_frequency": {"kind": "time_frequency", "frequency_Hz": 33.3, "amplitude_deg": 0.1, "phase_deg": 3.0},
    "drift": {"kind": "drift", "mode1_deg": 0.1, "mode2_deg": -0.3, "mode3_deg": 0.0, "mode4_deg": 0.0},
    "creep": {"kind": "creep", "amplitude_deg": 0.1, "time_constant_s": 7.3, "at_s": 60.0},
    "local": {"kind": "local", "centre_deg": 77.123, "width_deg": 8.4567, "height_deg": 0.2},
    "noise": {"kind": "noise", "first_row": 10.0, "last_row": 200.0, "rms_deg": 0.3},
    "of_a_kind_to_come": {"kind": "step", "step_deg": 0.3},
}


def answer_with(folder: Path, *structures: dict[str, Any]) -> Path:
    """An answer of explain that leaves these structures without a name; its sweep's name would end a docstring."""
    path = folder / "answer.json"
    sweep = {"name": 'x"""\\.csv', "speed_rpm": [60.0, 300.0]}
    content = {"schema": "halltwin.explain/1", "sweep": sweep, "unexplained": {"structure": list(structures)}}
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def written(folder: Path, kind: str, name: str = "belt_splice") -> Path:
    """The skeleton for a structure."""
    path = folder / f"{name}.py"
    shaped = ["--from", answer_with(folder, STRUCTURES[kind])] if STRUCTURES[kind] else []
    ended = halltwin("new-effect", name, "-o", path, *shaped)
    assert (ended.code, ended.err) == (0, "")
    assert ended.out.startswith(f"wrote {path}")
    return path


def refused(*arguments: str | Path) -> str:
    """What a command says that must refuse, in one line."""
    ended = halltwin(*arguments)
    assert ended.code == 2
    assert ended.err.startswith("halltwin: ")
    assert ended.err.count("\n") == 1
    return ended.err


def test_what_is_told_of_an_effect_binds_no_one(tmp_path: Path) -> None:
    """A file without the later declarations is loaded as ever; what is missing in it is said where it is checked."""
    path = written(tmp_path, "time_frequency")
    path.write_text(path.read_text().replace("record_wide=True,", ""))
    assert "belt_splice" in halltwin("causes", "--markdown", "--effects", path).out
    ended = halltwin("check-effect", path)
    assert ended.code == 2
    assert "record_wide=True" in " ".join(ended.out.split())


# ---- the skeleton -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", STRUCTURES)
def test_a_skeleton_keeps_the_contract(kind: str, tmp_path: Path) -> None:
    path = written(tmp_path, kind)
    ended = halltwin("check-effect", path)
    assert ended.code == 0, ended.out
    assert "BROKEN" not in ended.out
    assert max(len(line) for line in path.read_text().splitlines()) <= 120
    assert "belt_splice" in halltwin("causes", "--markdown", "--effects", path).out


@pytest.mark.skipif(not (find_spec("ruff") and find_spec("mypy")), reason="the linters are the extra `lint`")
def test_a_skeleton_lints(tmp_path: Path) -> None:
    names = [written(tmp_path, kind, f"own_{kind}").name for kind in STRUCTURES]
    root = str(SWEEP.parents[2])
    strict = ("mypy", "--strict", "--follow-imports=silent", f"--cache-dir={tmp_path / 'cache'}")
    layout = ("ruff", "format", "--isolated", "--line-length=120", "--check")
    for command in (("ruff", "check", "--isolated"), layout, strict):
        done = subprocess.run(
            [sys.executable, "-m", *command, *names],
            cwd=tmp_path,
            env={**os.environ, "MYPYPATH": root},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr


def test_a_skeleton_is_shaped_after_the_strongest_structure(tmp_path: Path) -> None:
    answer = answer_with(tmp_path, STRUCTURES["order"], STRUCTURES["time_frequency"])
    ended = halltwin("new-effect", "hum", "-o", tmp_path / "hum.py", "--from", answer)
    assert "33.30 Hz in time" in ended.out
    assert "the strongest of 2 structures" in ended.out
    assert "FREQUENCY_HZ = 33.3\n" in (tmp_path / "hum.py").read_text()


def test_a_whole_order_is_meant_where_one_is_near(tmp_path: Path) -> None:
    assert "ORDER = 13.0\n" in written(tmp_path, "order").read_text()
    assert "ORDER = 0.731812\n" in written(tmp_path, "order_between", "belt").read_text()


def test_figures_that_are_unknown_leave_the_skeleton_sound(tmp_path: Path) -> None:
    strange = {"kind": "local", "centre_deg": None, "width_deg": float("inf"), "height_deg": "much"}
    path = tmp_path / "bump.py"
    assert halltwin("new-effect", "bump", "-o", path, "--from", answer_with(tmp_path, strange)).code == 0
    assert halltwin("check-effect", path).code == 0


@pytest.mark.parametrize("structure", ["speed_squared_lag", "temperature_times_order", "local_bump", "time_frequency"])
def test_a_skeleton_finds_what_it_is_shaped_after(structure: str, tmp_path: Path) -> None:
    """Unnamed before, named after, with no less of a gain."""
    sweep = tmp_path / "sweep.csv"
    draw([], seed=9301, structure=structure).write_csv(sweep)
    before = explained(sweep)
    assert [cause["name"] for cause in before["causes"]] == ["unnamed"]
    shaped = tmp_path / "own_cause.py"
    halltwin("new-effect", "own_cause", "-o", shaped, "--from", tmp_path / "sweep.csv.answer.json")
    after = explained(sweep, "--effects", shaped)
    assert [cause["name"] for cause in after["causes"]] == ["own_cause"]
    assert after["extended"]["gain"] > 0.97 * before["extended"]["gain"]


@pytest.mark.parametrize("name", ["Belt", "belt-splice", "2nd", "belt__splice", "_belt", "belt splice", "größe"])
def test_names_that_are_none(name: str, tmp_path: Path) -> None:
    assert "lower-case words" in refused("new-effect", "-o", tmp_path / "x.py", "--", name)
    assert not (tmp_path / "x.py").exists()


def test_names_that_are_taken(tmp_path: Path) -> None:
    assert "in the catalogue already" in refused("new-effect", "hysteresis", "-o", tmp_path / "x.py")
    assert "begin with 'unnamed'" in refused("new-effect", "unnamed_belt", "-o", tmp_path / "x.py")
    path = written(tmp_path, "nothing")
    before = path.read_bytes()
    assert "is there already" in refused("new-effect", "belt_splice", "-o", path)
    assert path.read_bytes() == before
    assert "there is no folder" in refused("new-effect", "belt_splice", "-o", tmp_path / "no" / "x.py")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "no such file"),
        ("{", "is no answer"),
        ("[]", "is no answer"),
        ('{"schema": "halltwin.twin/1"}', "expected 'halltwin.explain/1'"),
        ('{"schema": "halltwin.explain/1", "unexplained": 3}', "is no answer"),
        ('{"schema": "halltwin.explain/1", "sweep": {}, "unexplained": {"structure": [3]}}', "is no answer"),
        ('{"schema": "halltwin.explain/1", "sweep": {}, "unexplained": {"structure": []}}', "no structure without"),
    ],
)
def test_answers_that_shape_nothing(content: str | None, said: str, tmp_path: Path) -> None:
    path = tmp_path / "answer.json"
    if content is not None:
        path.write_text(content)
    assert said in refused("new-effect", "belt_splice", "-o", tmp_path / "x.py", "--from", path)


# ---- what is refused --------------------------------------------------------------------------------------------

BROKEN = {
    "syntax": ("def forward(:\n", "line 1: SyntaxError"),
    "does not run": ("\n\nsurely_no_name\n", "line 3: NameError: name 'surely_no_name'"),
    "leaves": ("raise SystemExit(3)\n", "SystemExit: 3"),
    "no effect": ("x = 1\n", "declares no Effect"),
    "only the catalogue's": ("from twin.link.latency import LATENCY\n", "declares no Effect"),
    "not text": ("\x00", "mend the file"),
}
CHANGES = {
    "acts at its null": ("return signal + amplitude_rad", "return 1e-9 + signal + amplitude_rad", "at its null"),
    "another shape": ("return signal + amplitude_rad", "return signal[0] + amplitude_rad", "still changes the signal"),
    "not finite": ("np.sin(ORDER", "np.log(0.0 * ORDER", "still changes the signal"),
    "raises": (
        "return signal",
        "raise ValueError('two\\nlines')\n    return signal",
        "its code raises ValueError: two",
    ),
    "no unit": ('unit="deg"', 'unit=""', "amplitude_deg has no unit"),
    "no doc": ('doc="amplitude"', 'doc=""', "amplitude_deg has no doc"),
    "no source": ("which book, paper, drawing or data sheet defines this", "", "source is ''"),
    "taken name": ('name="belt_splice"', 'name="latency"', "'latency' is declared by the catalogue already"),
    "reserved name": ('name="belt_splice"', 'name="unnamed_belt"', "names that begin with 'unnamed'"),
    "always fitted": ('name="belt_splice",', 'name="belt_splice",\n    baseline=True,', "baseline is True"),
    "single readings": (
        'name="belt_splice",',
        'name="belt_splice",\n    footprint="sequence",',
        "footprint 'sequence' needs `marks`",
    ),
    "null outside": ("null=0.0, lower=0.0", "null=-1.0, lower=0.0", "ValueError: null -1.0 outside"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_files_that_cannot_be_used(case: str, tmp_path: Path) -> None:
    content, said = BROKEN[case]
    path = tmp_path / "own.py"
    path.write_text(content)
    for command in (("causes", "--effects", path), ("check-effect", path), ("explain", SWEEP, "--effects", path)):
        told = refused(*command)
        assert said in told
        assert "own.py" in told


@pytest.mark.parametrize("case", CHANGES)
def test_effects_that_break_the_contract(case: str, tmp_path: Path) -> None:
    old, new, said = CHANGES[case]
    path = written(tmp_path, "nothing")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    told = refused("explain", SWEEP, "--effects", path)
    assert said in told
    assert "belt_splice.py" in told
    assert halltwin("check-effect", path).code == 2


def test_files_that_are_none_or_given_twice(tmp_path: Path) -> None:
    assert "no such file" in refused("causes", "--effects", tmp_path / "none.py")
    assert "no such file" in refused("check-effect", tmp_path)
    path = written(tmp_path, "nothing")
    told = refused("causes", "--effects", path, "--effects", path)
    assert "effect 'belt_splice' is declared by belt_splice.py already" in told
    assert "read or written already" in refused("explain", SWEEP, "--effects", path, "--json", path)


def test_check_effect_says_which_promise_is_broken(tmp_path: Path) -> None:
    path = written(tmp_path, "nothing")
    path.write_text(path.read_text().replace("amplitude_rad *", "amplitude_rad ** 2 *"))
    ended = halltwin("check-effect", path)
    broken = [line for line in ended.out.splitlines() if "BROKEN" in line]
    assert ended.code == 2
    assert len(broken) == 1
    assert "half the strength, half the error" in broken[0]
    assert "1 broken in belt_splice" in ended.err


# ---- what they do -----------------------------------------------------------------------------------------------


def test_the_shipped_sweep_is_the_documented_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["gear_sweep", "-o", str(tmp_path / "gear.csv")])
    make_gear_sweep()
    assert (tmp_path / "gear.csv").read_bytes() == SWEEP.read_bytes()


@pytest.fixture(scope="module")
def gear(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what explain writes about the sweep with the gear's effect at hand."""
    folder = tmp_path_factory.mktemp("gear")
    outputs = ("--json", folder / "a.json", "--report", folder / "r.html", "--extended", folder / "gear.toml")
    ended = halltwin("explain", SWEEP, "--effects", GEAR, *outputs, "--plot", folder / "p.svg")
    assert (ended.code, ended.err) == (0, "")
    (folder / "console.txt").write_text(ended.out)
    return folder


def test_without_it_the_structure_has_no_name(tmp_path: Path) -> None:
    sweep = tmp_path / "gear.csv"
    sweep.write_bytes(SWEEP.read_bytes())
    answer = explained(sweep)
    assert [cause["name"] for cause in answer["causes"]] == ["unnamed"]
    kinds = {one["kind"]: one["order"] for one in answer["unexplained"]["structure"]}
    assert kinds == {"order": pytest.approx(13.0, abs=0.02), "direction": 13.0}
    path = tmp_path / "gear.csv.answer.json"
    halltwin("new-effect", "teeth", "-o", tmp_path / "teeth.py", "--from", path)
    answer = explained(sweep, "--effects", tmp_path / "teeth.py")
    # The skeleton has the order; what turns with the direction is its owner's to write.
    assert [cause["name"] for cause in answer["causes"]] == ["teeth", "unnamed"]


def test_with_it_the_cause_is_named_and_its_parameters_found(gear: Path) -> None:
    answer = json.loads((gear / "a.json").read_text())
    (cause,) = answer["causes"]
    assert (cause["name"], cause["stage"], answer["verdict"]) == ("gear_mesh", "mechanics", "explained")
    assert cause["false_alarm_probability"] < 1e-6
    truth = {"forward_deg": FORWARD_DEG, "backward_deg": BACKWARD_DEG, "phase_deg": PHASE_DEG}
    for name, value in truth.items():
        assert cause["parameters"][name]["low"] < value < cause["parameters"][name]["high"]
    assert answer["extended"]["gain"] > 3.3
    assert answer["unexplained"]["structure"] == []
    assert set(answer["twin"]["effects"]["gear_mesh"]) == set(truth)


def test_console_report_and_plot_speak_of_it(gear: Path) -> None:
    assert "1  gear_mesh" in (gear / "console.txt").read_text()
    report = (gear / "r.html").read_text()
    for said in ("twist on the way forward", "order 13, larger in one direction", 'class="name new">1 gear_<wbr>mesh'):
        assert said in report
    assert (gear / "p.svg").stat().st_size > 1000


def test_the_extended_twin_is_read_back_and_simulated(gear: Path) -> None:
    again = gear / "again.csv"
    assert "your own come with --effects FILE.py" in refused("simulate", gear / "gear.toml", "-o", again)
    ended = halltwin("simulate", gear / "gear.toml", "-o", again, "--effects", GEAR, "--both-directions", "--seed", "5")
    assert ended.code == 0
    given = explained(again, "--twin", gear / "gear.toml", "--effects", GEAR)
    assert (given["verdict"], given["causes"]) == ("adequate", [])
    assert given["baseline"]["rms_deg"] == pytest.approx(0.0165, rel=0.1)
    afresh = explained(again, "--effects", GEAR)
    assert [cause["name"] for cause in afresh["causes"]] == ["gear_mesh"]


def test_other_commands_read_such_a_twin(gear: Path) -> None:
    assert "--effects FILE.py" in refused("compensate", gear / "gear.toml")
    with_it = halltwin("compensate", gear / "gear.toml", "--effects", GEAR, "--toml", gear / "c.toml")
    assert with_it.code == 0
    correction = tomllib.loads((gear / "c.toml").read_text())
    thirteenth = np.hypot(correction["cosine_deg"][12], correction["sine_deg"][12])
    # A correction knows no direction: it takes out the mean of both.
    assert thirteenth == pytest.approx(0.5 * (FORWARD_DEG + BACKWARD_DEG), abs=0.005)


def test_it_is_a_rival_where_it_does_the_same(tmp_path: Path) -> None:
    twin = tmp_path / "twin.toml"
    effects = (
        "[effects.magnet_harmonic]\norder = 5\namplitude_deg = 0.1\nphase_deg = 20.0\n[effects.noise]\nrms_deg = 0.02\n"
    )
    twin.write_text(f'schema = "halltwin.twin/1"\n{effects}')
    sweep = tmp_path / "sweep.csv"
    assert halltwin("simulate", twin, "-o", sweep, "--turns", "2", "--no-channels").code == 0
    (cause,) = explained(sweep, "--effects", written(tmp_path, "nothing"))["causes"]
    assert {cause["name"], *cause["indistinguishable_from"]} >= {"magnet_harmonic", "belt_splice"}


# ---- installed packages -----------------------------------------------------------------------------------------


def installed(folder: Path, monkeypatch: pytest.MonkeyPatch, *, source: str, target: str) -> None:
    """A package on the path with one entry point of the group."""
    (folder / "bench_effects.py").write_text(source)
    info = folder / "bench_effects-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: bench-effects\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[halltwin.effects]\nbench = bench_effects:{target}\n")
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.delitem(sys.modules, "bench_effects", raising=False)


@pytest.mark.parametrize("target", ["EFFECT", "EFFECTS"])
def test_effects_of_an_installed_package_take_part(
    target: str, gear: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = GEAR.read_text() + "\n\nEFFECTS = [EFFECT]\n"
    installed(tmp_path, monkeypatch, source=source, target=target)
    assert "gear_mesh" in halltwin("causes", "--markdown").out
    assert halltwin("simulate", gear / "gear.toml", "-o", tmp_path / "s.csv").code == 0
    assert "is in the catalogue already" in refused("new-effect", "gear_mesh", "-o", tmp_path / "g.py")
    told = refused("causes", "--effects", GEAR)
    assert "'gear_mesh' is declared by package bench-effects, entry point 'bench' already" in told


def test_they_are_searched_for_without_being_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    installed(tmp_path, monkeypatch, source=GEAR.read_text(), target="EFFECT")
    assert "1  gear_mesh" in halltwin("explain", SWEEP).out


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("EFFECT = 3\n", "is no Effect and no sequence of them"),
        ("x = 1\n", "cannot be loaded (AttributeError"),
        ("1 / 0\n", "cannot be loaded (ZeroDivisionError: division by zero)"),
    ],
)
def test_packages_that_cannot_be_used(source: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    installed(tmp_path, monkeypatch, source=source, target="EFFECT")
    told = refused("causes")
    assert said in told
    assert "package bench-effects, entry point 'bench'" in told
