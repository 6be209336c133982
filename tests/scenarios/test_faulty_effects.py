"""Effects of one's own whose code does wrong end in one line with file and effect, whatever it raises or returns."""

from __future__ import annotations

import json
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from tests.command_line import halltwin
from tests.pages import ROOT
from twin.chain import Chain
from twin.example import full_motion
from twin.extensions import EffectError, effects_with
from twin.motion import Motion

DATA = Path(__file__).parents[2] / "scenarios/data"
SWEEP, GEAR = DATA / "gear_sweep.csv", DATA / "gear_mesh.py"
SEARCHED = 1440
"""Readings of the sweep: the search calls the effect a thousand times with as many, the checks with others."""


def refused(*arguments: str | Path) -> str:
    """The one line that a command refuses with."""
    ended = halltwin(*arguments)
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    return ended.err


FAULTS: dict[str, tuple[str, str]] = {
    "exits": ("raise SystemExit(0)", "forward raises SystemExit in line"),
    "raises what no program catches": ("raise GeneratorExit", "forward raises GeneratorExit in line"),
    "divides by zero": ("1 // 0", "ZeroDivisionError in line"),
    "writes to its motion": ("motion.time_s[...] = 0.0", "read-only; an effect may not write to what it is given"),
    "writes to its signal": ("signal[...] = 0.0", "read-only; an effect may not write to what it is given"),
    "returns one reading less": ("return after[..., 1:]", "returns an array of shape"),
    "returns a word": ("return 'after'", "returns str; expected an array of numbers"),
    "returns no number": ("return np.nan * after", "values that are not finite at forward_deg ="),
}


def in_its_place(folder: Path, code: str) -> Path:
    """The gear's effect with this ``forward`` in the place of its own, which is then called ``right``."""
    path = folder / "gear_mesh.py"
    source = GEAR.read_text().replace("def forward(", "def right(", 1)
    path.write_text(source.replace("EFFECT = ", f"{code}\n\nEFFECT = ", 1))
    return path


@pytest.mark.parametrize("case", FAULTS)
def test_a_fault_that_the_checks_do_not_meet_ends_in_one_line(case: str, tmp_path: Path) -> None:
    """Beyond the lengths at which promises are checked; the search itself is then the first to meet it."""
    code, said = FAULTS[case]
    path = in_its_place(
        tmp_path,
        f"""
def forward(signal, motion, values, rng):
    after = np.array(right(signal, motion, values, rng))
    if len(motion) > {len(full_motion())} and np.any(np.asarray(values["forward_deg"]) != 0.0):
        {code}
    return after
""",
    )
    motion = Motion.from_angle(np.linspace(0.0, 30.0, len(full_motion()) + 1))
    (effect,) = (one for one in effects_with([path]) if one.name == "gear_mesh")
    chain = Chain(effects=(effect,)).with_effect("gear_mesh", forward_deg=0.1)
    with pytest.raises(EffectError, match=r"^gear_mesh\.py: effect 'gear_mesh': forward ") as caught:
        chain.simulate(motion)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("error", ["SystemExit(0)", "GeneratorExit", "BaseException('no')"])
def test_a_file_that_ends_the_program_does_not_run(error: str, tmp_path: Path) -> None:
    path = tmp_path / "ends.py"
    path.write_text(f"raise {error}\n")
    assert "ends.py: line 1: " in refused("explain", SWEEP, "--effects", path)
    assert "ends.py: line 1: " in refused("check-effect", path)


def test_check_effect_finds_what_writes_to_its_motion(tmp_path: Path) -> None:
    path = tmp_path / "gear_mesh.py"
    path.write_text(GEAR.read_text().replace("    return ", "    motion.time_s[...] = 0.0\n    return ", 1))
    ended = halltwin("check-effect", path)
    assert ended.code == 2
    assert "read-only" in "".join(ended.out.split("\n"))


NO_ANSWERS = {
    "nothing": b"",
    "no text": bytes(range(256)),
    "lists in lists": b"[" * 100_000,
    "a list": b"[]",
    "another schema": b'{"schema": ["halltwin.explain/1"]}',
    "a number of many digits": (
        b'{"schema": "halltwin.explain/1", "sweep": {}, "unexplained": {"structure": [{"kind": "order", "x_deg": '
        + b"9" * 400
        + b"}]}}"
    ),
}


@pytest.mark.parametrize("case", NO_ANSWERS)
def test_a_skeleton_needs_an_answer(case: str, tmp_path: Path) -> None:
    path = tmp_path / "answer.json"
    path.write_bytes(NO_ANSWERS[case])
    told = refused("new-effect", "gear_wear", "--from", path, "-o", tmp_path / "gear_wear.py")
    assert "answer.json" in told
    assert not (tmp_path / "gear_wear.py").exists()


def test_an_interrupt_within_an_effect_gives_the_answer_so_far(tmp_path: Path) -> None:
    path = in_its_place(
        tmp_path,
        f"""
def forward(signal, motion, values, rng):
    import signal as signals
    global CALLS
    if len(motion) == {SEARCHED}:
        CALLS += 1
        if CALLS == 60:
            signals.raise_signal(signals.SIGINT)
    return right(signal, motion, values, rng)


CALLS = 0
""",
    )
    ended = halltwin("explain", SWEEP, "--effects", path, "--json", tmp_path / "answer.json")
    assert ended.code == 130
    assert ended.err.startswith("halltwin: stopping: the answer so far follows")
    assert ended.err.count("\n") == 1
    assert json.loads((tmp_path / "answer.json").read_text())["cut_short"]["stage"]


DECLARED = {
    "needs as a list": ("needs=frozenset({", "needs=list({", "needs is ['"),
    "no name": ('name="gear_mesh"', "name=None", "effect None: name is None; expected a text"),
    "a name that is none": ('name="gear_mesh"', "name=[]", "effect []: name is []; expected a text"),
    "a long name": ('name="gear_mesh"', f"name={'x' * 500!r} + 'X'", "lower-case words"),
    "no parameters": ("    params={", "    params=None and {", "params is None; expected names of parameters"),
    "a word for a function": ("forward=forward,", "forward='forward',", "forward is 'forward'; expected a function"),
    "a word for a line": ("forward=forward,", "forward=forward, line='x',", "line is 'x'; expected a Line, or None"),
    "a list for True": ("forward=forward,", "forward=forward, baseline=[],", "baseline is []; expected True or False"),
    "takes standard output": (
        "def forward(",
        "import sys\nsys.stdout = None\ndef forward(",
        "once it has run, sys.",
    ),
    "takes it at a call": ("    twist_deg", "    import sys\n    sys.stdout = None\n    twist_deg", "sys.stdout is"),
    "speaks of nothing": ("    twist_deg", "    raise Mute\n    twist_deg", "Mute: what it says cannot be shown"),
}
MUTE = """

class Mute(Exception):
    def __str__(self):
        raise ValueError


"""


@pytest.mark.parametrize("case", DECLARED)
def test_a_declaration_or_a_file_that_does_what_it_may_not_is_one_line(case: str, tmp_path: Path) -> None:
    text, instead, said = DECLARED[case]
    path = tmp_path / "gear_mesh.py"
    source = GEAR.read_text().replace("\n\nTEETH", f"{MUTE}TEETH", 1)
    assert text in source
    path.write_text(source.replace(text, instead, 1))
    told = refused("explain", SWEEP, "--effects", path)
    assert told.startswith("halltwin: gear_mesh.py: ")
    assert said in told
    assert len(told) < 500
    checked = halltwin("check-effect", path)
    assert checked.code == 2
    assert checked.err.startswith("halltwin: gear_mesh.py: ")


def test_an_effect_that_closes_standard_output_is_told(tmp_path: Path) -> None:
    """In a process of its own, whose standard output is then gone."""
    path = tmp_path / "gear_mesh.py"
    path.write_text(GEAR.read_text().replace("def forward(", "import sys\nsys.stdout.close()\n\n\ndef forward(", 1))
    command = [sys.executable, "-m", "scenarios.cli.main", "causes", "--effects", str(path)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr.count("\n")) == (2, "", 1)
    assert ended.stderr.startswith("halltwin: gear_mesh.py: once it has run, sys.stdout is closed or another one")


def test_what_an_effect_sets_for_itself_holds_for_nobody_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "gear_mesh.py"
    own = "import os, warnings\nnp.seterr(all='raise')\nwarnings.simplefilter('error')\nos.chdir('/')\n\n\n"
    called = "    np.seterr(all='raise')\n    twist_deg"
    path.write_text(
        GEAR.read_text().replace("def forward(", f"{own}def forward(", 1).replace("    twist_deg", called, 1)
    )
    before = np.geterr(), list(warnings.filters), Path.cwd()
    effects_with([path])
    assert (np.geterr(), list(warnings.filters), Path.cwd()) == before
