"""-h, --version, --quiet and --verbose: on every command, and each says as much as it promises."""

from __future__ import annotations

import re
from pathlib import Path
from unittest import mock

import pytest
from typer.main import get_command

from diagnosis.report.provenance import version
from scenarios.cli import app as commands
from scenarios.cli.app import app
from scenarios.cli.main import CRASHED
from tests import command_line
from tests.command_line import halltwin
from tests.pages import ROOT
from twin.log import LOG

SWEEP = ROOT / "scenarios/data/bench_sweep.csv"
COMMANDS = sorted(get_command(app).commands)


@pytest.mark.parametrize("command", COMMANDS)
def test_short_and_long_help_are_one(command: str) -> None:
    short, long = halltwin(command, "-h"), halltwin(command, "--help")
    assert short.code == 0
    assert short.out == long.out
    for option in ("--quiet", "--verbose", "-h"):
        assert option in short.out


def test_no_two_options_of_a_command_share_a_name() -> None:
    for command in get_command(app).commands.values():
        names = [name for param in command.params for name in (*param.opts, *param.secondary_opts)]
        assert len(names) == len(set(names)), command.name


def test_version_and_completion() -> None:
    assert halltwin("--version").out == f"halltwin {version()}\n"
    assert "--install-completion" in halltwin("-h").out


def test_quiet_prints_nothing_and_writes_the_same(tmp_path: Path) -> None:
    loud = halltwin("diagnose", SWEEP, "--json", tmp_path / "loud.json")
    quiet = halltwin("diagnose", SWEEP, "--json", tmp_path / "quiet.json", "--quiet")
    assert loud.out
    assert (quiet.code, quiet.out, quiet.err) == (0, "", "")
    assert (tmp_path / "quiet.json").read_bytes() == (tmp_path / "loud.json").read_bytes()


def test_quiet_tells_errors_and_what_is_failed_on() -> None:
    missing = halltwin("diagnose", "nowhere.csv", "-q")
    assert missing.code == 2
    assert missing.err.startswith("halltwin: nowhere.csv")
    assert missing.err.count("\n") == 1
    found = halltwin("explain", SWEEP, "-q", "--fail-on", "cause")
    assert (found.code, found.out) == (1, "")
    assert found.err == "halltwin: found cause (hysteresis), as --fail-on asks\n"


def test_verbose_says_on_stderr_what_is_done_and_leaves_the_answer_alone() -> None:
    plain, told = halltwin("explain", SWEEP), halltwin("explain", SWEEP, "--verbose")
    assert told.out == plain.out
    assert plain.err == ""
    lines = told.err.splitlines()
    assert all(re.match(r" *\d+ ms  ", line) for line in lines)
    for said in (
        rf"halltwin {re.escape(version())}, Python 3",
        r"command: halltwin explain .*bench_sweep\.csv --verbose",
        r"read bench_sweep\.csv: 1440 rows, 0 rejected; .*reference_deg",
        r"seed 0; settings: .*false_alarm\w* 0\.01",
        r"stage observe; held so far: no cause",
        r"stage predictive_check; held so far: hysteresis",
        r"done in [\d.]+ s",
    ):
        assert re.search(said, told.err), said


def test_verbose_leaves_the_logger_as_it_was() -> None:
    before = (LOG.level, list(LOG.handlers))
    assert halltwin("diagnose", "nowhere.csv", "-v").code == 2
    assert (LOG.level, list(LOG.handlers)) == before


def test_less_and_more_exclude_each_other() -> None:
    both = halltwin("causes", "-q", "-v")
    assert both.code == 2
    assert "exclude each other" in both.err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("explain",), "missing argument"),
        (("explain", SWEEP, "--sed", "1"), "no such option"),
        (("explain", SWEEP, "--seed", "one"), "--seed"),
        (("explain", SWEEP, "--seed", "-1"), "--seed"),
        (("simulate", "--points", "36.9"), "--points"),
        (("simulate", "--points", "12", "--points", "13"), "--points is given more than once; give it once"),
        (("simulate", "--force", "--force"), "--force is given more than once; give it once"),
        (("explode",), "no such command"),
    ],
)
def test_a_usage_error_is_one_line(arguments: tuple[str | Path, ...], said: str) -> None:
    ended = halltwin(*arguments)
    assert ended.code == 2
    assert ended.out == ""
    assert said in ended.err
    command = "" if arguments[0] == "explode" else f"{arguments[0]}: "
    assert ended.err.startswith(f"halltwin: {command}")
    assert ended.err.endswith("-h lists what it takes\n")
    assert len(ended.err.splitlines()) == 1


def test_a_fault_of_the_program_is_told_from_an_answer(capsys: pytest.CaptureFixture[str]) -> None:
    """Its traceback is shown, and the exit code is neither that of a finding nor that of a mistake of the user's."""
    with (
        mock.patch.object(commands, "app", side_effect=ZeroDivisionError("a fault")),
        pytest.raises(AssertionError, match="ZeroDivisionError: a fault"),
    ):
        halltwin("causes")
    assert command_line.CRASHED == CRASHED == 70
