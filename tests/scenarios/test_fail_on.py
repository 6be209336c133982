"""--fail-on: exit code 1 for what was asked about and is there, 0 for what is not, 2 for what no command knows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis import Explanation, explain
from scenarios.commands import explain as command
from scenarios.commands.fail_on import in_diagnoses, in_explanation, in_loop
from tests.command_line import halltwin
from tests.pages import ROOT
from twin.angles import TAU
from twin.chain import Chain
from twin.files import write_twin
from twin.motion import Motion
from twin.sweep import Sweep

SWEEP = ROOT / "scenarios/data/bench_sweep.csv"
GEAR = ROOT / "scenarios/data/gear_sweep.csv"


def cause(name: str, *rivals: str) -> dict[str, object]:
    return {"name": name, "indistinguishable_from": list(rivals)}


def test_what_an_explanation_holds() -> None:
    sweep = {"name": "s.csv", "rejected": 0}
    same: dict[str, Any] = {"changed": [], "other_device": None, "setup": []}
    assert in_explanation({"sweep": sweep, "causes": [], **same}) == {}
    found = in_explanation(
        {"sweep": sweep | {"rejected": 1}, "causes": [cause("latency", "xy_skew"), cause("unnamed")], **same}
    )
    assert found == {
        "latency": "latency",
        "xy_skew": "cannot be told from latency",
        "cause": "latency",
        "unexplained": "structure without a name",
        "rejected": "1 row of s.csv",
    }


def test_an_explanation_holds_what_is_wrong_with_the_set_up() -> None:
    answer = {"sweep": {"name": "s.csv", "rejected": 0}, "causes": [], "changed": [], "other_device": None}
    setup = [
        {"kind": "off_centre", "level": "fault", "what": "the magnet is off the axis"},
        {"kind": "time_jitter", "level": "note", "what": "the clock jitters"},
    ]
    told = {"off_centre": "the magnet is off the axis", "fault": "off_centre", "note": "time_jitter"}
    assert in_explanation({**answer, "setup": setup}) == told | {"time_jitter": "the clock jitters"}
    both = in_explanation({**answer, "setup": setup, "causes": [cause("time_jitter")]})
    assert both["time_jitter"] == "time_jitter"


def test_what_diagnoses_hold() -> None:
    sure = {"at_bound": False, "low": 0.0, "high": 1.0}
    clean = {"sweep": "a.csv", "glitch_rows": [], "rejected": 0, "parameters": {"quad": sure}}
    assert in_diagnoses({"sweeps": [clean]}) == {}
    open_end = clean | {"sweep": "b.csv", "parameters": {"quad": sure | {"profile": [0.0, None]}, "beta_deg": sure}}
    at_bound = clean | {"sweep": "c.csv", "parameters": {"quad": sure | {"at_bound": True}}, "glitch_rows": [3, 9]}
    found = in_diagnoses({"sweeps": [clean, open_end, at_bound]})
    assert found == {"undetermined": "quad of b.csv", "gross-errors": "2 in c.csv"}


def test_what_a_closed_loop_holds() -> None:
    report = {"after": {"largest_deg": 0.31}, "aim_deg": 0.2}
    assert in_loop({**report, "reached": True}) == {}
    assert in_loop({**report, "reached": False}) == {"missed": "largest error 0.310 deg, aim 0.2 deg"}


def test_bench_fails_on_nothing_but_a_closed_loop(tmp_path: Path) -> None:
    pytest.importorskip("can")
    pytest.importorskip("cantools")
    ended = halltwin("bench", "--fail-on", "missed", "-o", tmp_path / "b.csv")
    assert ended.code == 2
    assert "give --closed-loop" in ended.err
    assert list(tmp_path.iterdir()) == []


ANSWERS: dict[tuple[str, tuple[Path, ...]], Explanation] = {}


@pytest.fixture
def asked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The answer to each sweep is searched for once; what the command makes of it is what is tested."""

    def answer(sweep: Sweep, *, effects: Sequence[Path], **_: Any) -> Explanation:
        key = (sweep.name, tuple(effects))
        if key not in ANSWERS:
            ANSWERS[key] = explain(sweep, effects=effects)
        return ANSWERS[key]

    monkeypatch.setattr(command, "_explained", answer)


@pytest.mark.parametrize(
    ("sweep", "asked", "code"),
    [
        (SWEEP, ("cause",), 1),
        (SWEEP, ("hysteresis",), 1),
        (SWEEP, ("backlash",), 0),
        (SWEEP, ("unexplained,rejected",), 0),
        (GEAR, ("unexplained",), 1),
        (SWEEP, ("lost",), 2),
        (SWEEP, ("fault,note,axial_magnet",), 0),
    ],
)
@pytest.mark.usefixtures("asked_once")
def test_explain(sweep: Path, asked: tuple[str, ...], code: int) -> None:
    assert halltwin("explain", sweep, *(word for text in asked for word in ("--fail-on", text))).code == code


@pytest.mark.usefixtures("asked_once")
def test_explain_knows_causes_of_ones_own() -> None:
    own = ROOT / "scenarios/data/gear_mesh.py"
    assert halltwin("explain", GEAR, "--effects", own, "--fail-on", "gear_mesh").code == 1
    assert halltwin("explain", GEAR, "--fail-on", "gear_mesh").code == 2


@pytest.mark.usefixtures("asked_once")
def test_files_are_written_before_the_command_ends(tmp_path: Path) -> None:
    ended = halltwin("explain", SWEEP, "--fail-on", "cause", "--json", tmp_path / "a.json")
    assert ended.code == 1
    assert (tmp_path / "a.json").stat().st_size > 1000
    assert "Verdict" in ended.out


def test_diagnose(tmp_path: Path) -> None:
    angle = TAU * np.arange(72) / 72
    sweep = Chain().with_effect("noise", rms_deg=0.02).simulate(Motion.from_angle(angle), seed=0)
    sweep.write(tmp_path / "a.csv")
    text = (tmp_path / "a.csv").read_text().splitlines()
    text[20] = ",".join(["" if k else "190.0" for k in range(len(text[20].split(",")))])
    (tmp_path / "a.csv").write_text("\n".join(text) + "\n")
    assert halltwin("diagnose", tmp_path / "a.csv", "--fail-on", "gross-errors").code == 0
    ended = halltwin("diagnose", tmp_path / "a.csv", "--fail-on", "gross-errors", "--fail-on", "rejected")
    assert (ended.code, ended.err) == (1, "halltwin: found rejected (1 row of a.csv), as --fail-on asks\n")


@pytest.fixture(scope="module")
def series(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twenty-four sweeps there and back, whose lag grows after the twelfth while nothing else changes."""
    path = tmp_path_factory.mktemp("series")
    way = TAU * np.arange(60) / 60
    motion = Motion.from_angle(np.concatenate([way, way[::-1]]))
    for k in range(24):
        sensor = Chain().with_effect("hysteresis", lag_deg=0.1 + 0.02 * max(k - 12, 0), memory_deg=5.0)
        sensor.with_effect("noise", rms_deg=0.02).simulate(motion, seed=k).write(path / f"sweep{k:02d}.csv")
    return path


def test_monitor(series: Path) -> None:
    ended = halltwin("monitor", series)
    assert ended.code == 0
    assert "lag drifts up" in ended.out
    failed = halltwin("monitor", series, "--fail-on", "gain_ratio,lag_deg")
    assert (failed.code, failed.out) == (1, ended.out)
    assert failed.err.startswith("halltwin: found lag_deg (up, signalled at sweep")
    assert halltwin("monitor", series, "--fail-on", "gain").code == 2


def test_a_correction_that_makes_the_error_larger(tmp_path: Path) -> None:
    """Of another device, with the opposite offset: --check fails by itself, and says what to do."""
    motion = Motion.from_angle(TAU * np.arange(72) / 72)
    for name, offset in (("one", 0.8), ("other", -0.8)):
        sensor = Chain().with_effect("offset", x_percent=offset).with_effect("noise", rms_deg=0.01)
        sensor.simulate(motion, seed=0).write(tmp_path / f"{name}.csv")
        write_twin(tmp_path / f"{name}.toml", sensor)
    good = halltwin("compensate", tmp_path / "one.toml", "--check", tmp_path / "one.csv")
    assert (good.code, good.err) == (0, "")
    bad = halltwin(
        "compensate", tmp_path / "one.toml", "--check", tmp_path / "other.csv", "--toml", tmp_path / "c.toml"
    )
    assert bad.code == 1
    assert bad.err.startswith("halltwin: the correction makes the error larger on other.csv (0.32")
    assert bad.err.endswith("do not load it\n")
    assert (tmp_path / "c.toml").exists()


@pytest.mark.parametrize("command", [("compensate",), ("export", "--for", "lut")], ids=" ".join)
def test_held_out_readings_fail_only_where_asked(command: tuple[str, ...], tmp_path: Path) -> None:
    """A perfect sensor leaves a correction nothing but noise to fit: it does harm, if little."""
    motion = Motion.from_angle(TAU * np.arange(36) / 36)
    Chain().with_effect("noise", rms_deg=0.05).simulate(motion, seed=1).write(tmp_path / "a.csv")
    told, failed = (halltwin(*command, tmp_path / "a.csv", *more) for more in ((), ("--fail-on", "worse")))
    assert told.code == 0
    assert "the correction makes the error larger on held-out blocks" in told.out
    assert failed.code == 1
