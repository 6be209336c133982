"""The command line as a whole: what it loads before a command runs, and that each command says what it does."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from typer.main import get_command

from scenarios.cli.app import app
from scenarios.commands import causes
from tests.command_line import halltwin

ROOT = Path(__file__).parents[3]
COMMANDS = sorted(get_command(app).commands)


def loaded_by(statement: str) -> set[str]:
    """Every module that a fresh interpreter has loaded after a statement."""
    command = [sys.executable, "-c", f"{statement}; import sys; print(*sys.modules)"]
    return set(subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.split())


def test_help_waits_for_nothing_but_typer() -> None:
    own = loaded_by("import scenarios.cli.app") - loaded_by("import os, pathlib, typing, typer")
    assert {name for name in own if name != "scenarios" and not name.startswith("scenarios.cli")} == set()


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_and_every_option_says_what_it_is(command: str) -> None:
    found = get_command(app).commands[command]
    assert found.help
    assert [option.name for option in found.params if not option.help] == []
    assert halltwin(command, "--help").code == 0


UNITS = {"deg": "deg", "mm": "mm", "mT": "mT", "s": "s", "C": "C", "rpm": "rpm", "T": "T"}
"""Unit by the placeholder that stands for a value in the help."""


@pytest.mark.parametrize("command", COMMANDS)
def test_every_value_has_a_placeholder_and_a_unit_is_said_in_words_too(command: str) -> None:
    """A number's unit stands in the placeholder and in the sentence, so that neither has to be guessed."""
    for option in get_command(app).commands[command].params:
        placeholder = str(option.metavar or "")
        assert placeholder or getattr(option, "is_flag", False) or option.param_type_name == "argument", option.name
        for part in placeholder.split(":")[0].split(",")[:1]:
            if part in UNITS:
                assert f" {UNITS[part]}" in str(option.help), f"{command} {option.name}"


# ---- Ctrl-C ------------------------------------------------------------------------------------------------------

INTERRUPTED_AT = """
import signal, sys
from scenarios.cli.main import main


class Finder:
    def find_spec(name, path=None, target=None):
        if name == {module!r}:
            signal.raise_signal(signal.SIGINT)


sys.meta_path.insert(0, Finder)
sys.argv = ["halltwin", "simulate", "-o", {output!r}]
main()
"""


@pytest.mark.parametrize("module", ["typer", "scenarios.cli.sweeps", "numpy", "twin.chain", "twin.sweep_file"])
def test_an_interrupt_while_modules_are_loaded_is_one_line(module: str, tmp_path: Path) -> None:
    code = INTERRUPTED_AT.format(module=module, output=str(tmp_path / "sweep.csv"))
    ended = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (130, "")
    assert ended.stderr == "halltwin: interrupted; nothing was written\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("options", [(), ("--quiet",)], ids=str)
def test_an_interrupt_is_told_whatever_the_command_does(
    options: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(**given: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(causes, "run", interrupted)
    ended = halltwin("causes", *options)
    assert (ended.code, ended.out, ended.err) == (130, "", "halltwin: interrupted; nothing was written\n")


# ---- the day -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("day", ["abc", "1.5", " ", "9" * 30])
def test_a_day_that_is_none_is_refused_by_every_command(day: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", day)
    ended = halltwin("causes")
    assert (ended.code, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert "SOURCE_DATE_EPOCH is" in ended.err


def test_an_empty_day_counts_as_unset() -> None:
    """As modules of scipy read it too, which are loaded on the way, a process of its own is needed."""
    command = [sys.executable, "-m", "scenarios.cli.main", "diagnose", "scenarios/data/bench_sweep.csv"]
    environment = {**os.environ, "SOURCE_DATE_EPOCH": ""}
    ended = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (0, "")


# ---- empty values ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", COMMANDS)
def test_an_empty_value_is_refused_for_each_option(command: str) -> None:
    """As the name of a file it would mean the working folder."""
    for param in get_command(app).commands[command].params:
        if getattr(param, "is_flag", False) or param.default == "" or param.name in ("help", "quiet", "verbose"):
            continue
        given = [""] if param.param_type_name == "argument" else [max(param.opts, key=len), ""]
        ended = halltwin(command, *given)
        assert (ended.code, ended.out) == (2, ""), param.name
        assert "is empty; give a value" in " ".join(ended.err.split()), param.name
