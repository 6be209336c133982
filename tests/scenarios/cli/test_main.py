"""The command line as a whole: what it loads before a command runs, and that each command says what it does."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from typer.main import get_command

from scenarios.cli.app import app
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
