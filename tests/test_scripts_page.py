"""The page on scripts lists every exit code, and every word that --fail-on knows."""

from __future__ import annotations

import re

from diagnosis.factors.series import UNITS
from scenarios.cli.main import CRASHED
from scenarios.cli.streams import READER_GONE
from scenarios.commands.fail_on import BENCH, COMPENSATE, DIAGNOSE, EXPLAIN, EXPORT, MONITOR
from scenarios.commands.interrupt import INTERRUPTED
from tests.pages import GUIDE
from twin.catalogue import CATALOGUE
from twin.presets import preset_names

PAGE = (GUIDE / "scripts.md").read_text(encoding="utf-8")
WORDS = {
    "explain": EXPLAIN,
    "diagnose": DIAGNOSE,
    "monitor": MONITOR,
    "compensate": COMPENSATE,
    "export": EXPORT,
    "bench": BENCH,
}


def test_words_to_fail_on() -> None:
    listed: dict[str, set[str]] = {command: set() for command in WORDS}
    for row in re.findall(r"^\| (`(?:explain|diagnose|monitor|compensate|export|bench)[^|]*)\| ([^|]*) \|", PAGE, re.M):
        for command in re.findall(r"`(\w+)", row[0]):
            listed[command] |= set(re.findall(r"`([^`]+)`", row[1]))
    examples = {effect.name for effect in CATALOGUE} | set(UNITS)
    assert {command: words - examples for command, words in listed.items()} == {
        command: set(words) for command, words in WORDS.items()
    }
    # A row that gives names as examples gives some.
    assert listed["explain"] & examples
    assert listed["monitor"] & set(UNITS)


def test_exit_codes() -> None:
    assert [int(code) for code in re.findall(r"^\| (\d+) \|", PAGE, re.M)] == [
        0,
        1,
        2,
        CRASHED,
        INTERRUPTED,
        READER_GONE,
    ]


def test_presets() -> None:
    named = set(re.findall(r"`([a-z]+-[a-z0-9]+)`", PAGE)) - {"gross-errors", "other-device"}
    assert named == set(preset_names())
