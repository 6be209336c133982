"""Every number on the command line, given as what it may be by mistake: refused in one line, or a right answer.

The options are found by walking over the command line, so that a new one is tried too: it is expected to refuse all of
:data:`ODD` unless it is listed in :data:`RIGHT`.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.fuzz.trial import within
from twin.errors import UserError

from .command_line import Ended, halltwin
from .option_walk import ODD, Option, options

BASE: dict[str, tuple[str, ...]] = {
    "explain": ("short.csv",),
    "simulate": ("--points", "16", "-o", "out/sweep.csv"),
    **dict.fromkeys(
        (f"simulate --{name}" for name in ("start-rpm", "stop-rpm", "coast-time", "dry-share", "rate")),
        ("--coast", "-o", "out/sweep.csv"),
    ),
    "diagnose": ("short.csv",),
    "spinning": ("-o", "out/spinning"),
    "hardware": ("-o", "out/hardware"),
    "paper": ("-o", "out/paper"),
    "compensate": ("short.csv", "--header", "out/c.h"),
    "compensate --temperature": ("paper-encoder", "--header", "out/c.h"),
    "export": ("paper-encoder", "--for", "lut", "-o", "out/t.csv"),
    "import": ("short.csv", "-o", "out/sweep.csv"),
    "doctor": ("short.csv",),
    "monitor": tuple(f"s{k}.csv" for k in range(8)),
    "bench": ("--points", "8", "-o", "out/bench.csv"),
    **dict.fromkeys(("bench --spin-time", "bench --rate"), ("--spin", "coast", "-o", "out/bench.csv")),
    "generate": ("-o", "out/study"),
    "design": ("-o", "out/study", "--no-plot"),
    "recover": ("-o", "out/study", "--no-plot"),
    "fleet": (*(f"s{k}.csv" for k in range(8)), "-o", "out/study"),
    "lab": ("--no-browser",),
}
"""Arguments with which a command does little; a study ends where its work would begin."""
WORDS = frozenset(
    {
        *("--check", "--prefix", "--twin", "--hide", "--interface", "--channel", "--bus-option", "--fault", "--cause"),
        *("--shape", "--grade", "--sampling", "--scheduler", "--fail-on"),
        *("--for", "--name", "--least"),
        *("--order", "--explain"),
        "--columns",
        "--spin",
    }
)
"""Options that take no number."""
RIGHT: dict[str, str] = {
    "--seed": "0",
    "--band": "36.9",
    "--budget": "36.9 1e308 inf",
    "--speed-rpm": "0 36.9",
    "bench --speed-rpm": "0",
    "--temperatures": "-1 0 36.9",
    "--temperature": "-1 0 36.9",
    "--mounting": "-1 0 36.9",
    "--settle": "0 36.9",
    "--manifest": "0 36.9",
    "--spin-time": "36.9",
    "--timeout": "36.9",
    "--run-length": "36.9",
    "simulate --max-size": "36.9",
    "export --max-size": "36.9",
    "--start-rpm": "36.9",
    "--stop-rpm": "0 36.9",
    "--coast-time": "36.9",
    "--dry-share": "0",
    "simulate --noise": "0 36.9",
    # A lag that is 0.1 deg at the preset's gap would be 22 deg there.
    "simulate --air-gap": "",
    "compensate --tolerance": "0",
    "--most-causes": "0",
    "--min-yield": "0",
    "--max-error": "36.9",
    "--window": "0 36.9",
    "--bore": "0 36.9",
    "--output-sense": "-1",
    "--remanence": "0",
    "--port": "0",
    **dict.fromkeys(("--diameter", "--height", "--air-gap"), "36.9"),
    **dict.fromkeys(("--off-axis", "--tilt", "--magnet-off-axis", "--magnet-tilt", "--stray"), "-1 0 36.9"),
}
"""Which of ODD are right, by option, or by command and option; a bore is what a ring alone has."""
NONE_IS_RIGHT = frozenset({"--temperatures"})
"""Where nothing at all between the quotes means none."""
LONG = frozenset({"explain", "spinning", "hardware", "paper", "diagnose", "generate"})
"""Commands that take their time: what is right for them is tried elsewhere."""
BEGUN = "the study would begin"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder with short sweeps, in which the commands run."""
    here, before = tmp_path_factory.mktemp("options"), Path.cwd()
    os.chdir(here)
    halltwin("simulate", "-o", "short.csv", "--points", "36")
    for k in range(8):
        halltwin("simulate", "-o", f"s{k}.csv", "--points", "16", "--seed", str(k + 1))
    yield here
    os.chdir(before)


def begun(*_: object, **__: object) -> int:
    raise UserError(BEGUN)


def run(command: str, option: str, value: str) -> Ended:
    """The command with one option more, or another value of it, in a fresh folder for its outputs."""
    shutil.rmtree("out", ignore_errors=True)
    Path("out").mkdir()
    others = list(BASE.get(f"{command} {option}", BASE[command]))
    if option in others:
        del others[others.index(option) : others.index(option) + 2]
    with within(30):
        return halltwin(command, *others, f"{option}={value}")


NUMBERS = [one for one in options() if one.kind in ("number", "text") and one.name not in WORDS]


@pytest.mark.parametrize("option", NUMBERS, ids=lambda one: f"{one.command} {one.name}")
def test_what_no_number_can_mean_is_refused(option: Option, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("design", "recovery", "training", "fleet"):
        monkeypatch.setattr(f"scenarios.studies.{module}.run.run_study", begun)
    monkeypatch.setattr("scenarios.lab.command.Server", begun)
    full = f"{option.command} {option.name}"
    right = RIGHT.get(full, RIGHT.get(option.name, "")).split()
    right += [""] if {full, option.name} & NONE_IS_RIGHT else []
    for value in ODD:
        if value in right and option.command in LONG:
            continue
        ended = run(option.command, option.name, value)
        assert (ended.code == 0 or BEGUN in ended.err) == (value in right), (value, ended)
        if value not in right:
            assert ended.code == 2
            # The command line's own words stand in a box; others in one line.
            assert "Invalid value" in ended.err or ended.err.count("\n") == 1
