"""What the name of an output may be, and what goes where the printed answer goes."""

from __future__ import annotations

import csv
import gzip
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from scenarios.commands.marks import is_own
from scenarios.commands.outputs import HEADER, HTML, JSON, PICTURE, SWEEP, TABLE, TOML, OutputFiles
from tests.pages import ROOT
from tests.scenarios.test_outputs import keeps_attributes

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}
CONTENTS = {
    ".csv": (TABLE, "x_deg\n1\n"),
    ".csv.gz": (SWEEP, "x_deg\n1\n"),
    ".json": (JSON, "{\n}\n"),
    ".toml": (TOML, "x = 1\n"),
    ".html": (HTML, "<p>\n"),
    ".htm": (HTML, "<p>\n"),
    ".h": (HEADER, "int x;\n"),
    ".hpp": (HEADER, "int x;\n"),
    **{end: (PICTURE, lambda: Figure(figsize=(1.0, 1.0))) for end in (".png", ".svg", ".pdf")},
}


@pytest.mark.parametrize("ending", CONTENTS)
def test_a_name_may_be_nothing_but_an_ending_and_in_capitals(ending: str, tmp_path: Path) -> None:
    form, content = CONTENTS[ending]
    for path in (tmp_path / ending, tmp_path / f"A{ending.upper()}"):
        for _ in range(2):
            # Known for its own by its mark, the file is replaced unasked.
            OutputFiles.checked([(path, form)]).write({path: content})
        raw = path.read_bytes()
        assert gzip.decompress(raw) == b"x_deg\n1\n" if ending.endswith(".gz") else raw
        assert is_own(path) or not keeps_attributes(tmp_path)


def test_what_goes_to_standard_output_is_not_told_in_it(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "scenarios.cli.main", "simulate", "-o", "/dev/stdout"]
    ended = subprocess.run(command, stdout=subprocess.PIPE, env=ENVIRONMENT, check=True, text=True)
    assert len(list(csv.DictReader(ended.stdout.splitlines()))) == 360
    assert "wrote" not in ended.stdout


def test_what_is_read_is_not_printed_into(tmp_path: Path) -> None:
    """As with ``>> sweep.csv`` in a shell, or ``> answer.csv`` where the folder is read."""
    shutil.copy(ROOT / "scenarios/data/bench_sweep.csv", tmp_path / "sweep.csv")
    for read, name in (("sweep.csv", "sweep.csv"), (".", "answer.csv")):
        target = tmp_path / name
        before = target.read_bytes() if target.exists() else b""
        with target.open("ab") as out:
            command = [sys.executable, "-m", "scenarios.cli.main", "diagnose", read]
            ended = subprocess.run(
                command, stdout=out, stderr=subprocess.PIPE, env=ENVIRONMENT, cwd=tmp_path, check=False
            )
        assert ended.returncode == 2
        assert b"is read, and standard output goes to it" in ended.stderr
        assert target.read_bytes() == before
