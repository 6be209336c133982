"""Every block of commands on the pages is run as it stands, by a shell; where its output is shown, that is what comes.

Blocks marked ``sh`` are for a shell, from the top folder of the repository or with files of the reader's own
(``tests/guide_files.py``); each page's run one after the other in one folder. Options in
running text are checked to be there.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from scenarios.cli.app import app
from tests.guide_files import STAND_FOR
from tests.pages import GUIDE, PAGES, ROOT, block, figures, lines, words

BLOCK = re.compile(r"^```sh\n(.*?)^```", re.M | re.S)
RUN_ELSEWHERE = {
    "python3 -m venv": "the first walk, by tests/scenarios/lab/test_first_walk.py, and CI",
    "halltwin paper": "tests/scenarios/test_paper.py",
}
"""How blocks begin that other tests run."""
SHOWN = {
    "README": ("example",),
    "choose_magnet": ("design",),
    "drive_tables": ("export",),
    "explain_sweep": ("later",),
    "production_line": ("fleet",),
    "spins": ("coast",),
    "temperature": ("warm",),
}
"""Outputs that a page shows of its commands; those of other commands are held by tests of their own."""
HALLTWIN = """#!{python}
import signal, subprocess, sys
command = [sys.executable, "-m", "scenarios.cli.main", *sys.argv[1:]]
if sys.argv[1] != "lab":
    sys.exit(subprocess.call(command))
served = subprocess.Popen([*command, "--no-browser"], stdout=subprocess.PIPE, text=True)
for line in served.stdout:
    if line.startswith("only this machine"):
        served.send_signal(signal.SIGINT)
sys.exit(served.wait())
"""
"""The command; the page is served, and ended as Ctrl-C does as soon as it says where it is."""
RANK = re.compile(r"\(p = ([\d.]+)\)")


def blocks(page: Path) -> list[str]:
    """The blocks of a page that are run here."""
    found = BLOCK.findall(page.read_text(encoding="utf-8"))
    return [text for text in found if not text.startswith(tuple(RUN_ELSEWHERE))]


RUN = [page for page in PAGES if page.parent.name != ".github" and blocks(page)]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the repository's data where they lie in its top folder, and the command."""
    work = tmp_path / "work"
    for made in (work, tmp_path / "bin"):
        made.mkdir()
    # A copy: some commands write there.
    shutil.copytree(ROOT / "scenarios" / "data", work / "scenarios" / "data")
    (tmp_path / "bin" / "halltwin").write_text(HALLTWIN.format(python=sys.executable))
    (tmp_path / "bin" / "halltwin").chmod(0o755)
    return work


@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
def test_commands_run_as_they_stand(page: Path, folder: Path) -> None:
    for needed in ("matplotlib", "xarray", "zarr", "distributed", "can"):
        pytest.importorskip(needed)
    STAND_FOR.get(page.stem, lambda _: None)(folder)
    path = f"{folder.parent / 'bin'}{os.pathsep}{os.environ['PATH']}"
    surroundings = {**os.environ, "PATH": path, "PYTHONPATH": str(ROOT), "COLUMNS": "100"}
    said = ""
    for text in blocks(page):
        ended = subprocess.run(
            ["bash", "-e", "-c", text],
            cwd=folder,
            env=surroundings,
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert ended.returncode == 0, f"{text}{ended.stdout}{ended.stderr}"
        assert "Traceback" not in ended.stderr
        said += ended.stdout
    if page.stem == "training_data":
        read_store(folder)
    for name in SHOWN.get(page.stem, ()):
        assert_shown(block(page, name), said)


PYTHON = {"README": "python", "own_effects": "thermal_zero_shift, own", "training_data": "store"}
"""Every block of Python on the pages but those of a prompt: tests of the README and of the guide hold the first two."""


def test_every_block_of_python_is_run() -> None:
    texts = {
        page.stem: page.read_text(encoding="utf-8").count("\n```python\n")
        for page in PAGES
        if page.parent.name != ".github"
    }
    assert {name: count for name, count in texts.items() if count} == {
        name: len(parts.split(", ")) for name, parts in PYTHON.items()
    }


def read_store(folder: Path) -> None:
    """The page's class reads the store that the page's command has written."""
    code = block(GUIDE / "training_data.md", "store", "python")
    told = "\nprint(len(sweeps), error_deg.shape, int(label.sum()) in (0, 1, 2, 3), len(list(sweeps)) == len(sweeps))"
    ran = subprocess.run([sys.executable, "-c", code + told], cwd=folder, capture_output=True, text=True, timeout=100)
    assert re.fullmatch(r"1\d\d \(360,\) True True\n", ran.stdout), ran


def assert_shown(shown: str, said: str) -> None:
    """The lines that a page shows stand in an output, one behind the other; their figures to a few percent.

    The rank of a predictive check may differ by some of its 199 sweeps; half widths are not compared.
    """
    wanted, found = words(shown), words(said)
    # lines() strips blanks at both ends of a text.
    begins = [k for k, line in enumerate(found) if line.strip() == wanted[0]]
    starts = [k for k in begins if found[k + 1 : k + len(wanted)] == wanted[1:]]
    assert starts, f"{shown}\n--- is not in ---\n{said}"
    real = "\n".join(lines(said)[starts[0] : starts[0] + len(wanted)])
    for one, other in zip(RANK.findall(shown), RANK.findall(real), strict=True):
        assert float(one) == pytest.approx(float(other), abs=0.05)
    for one, other in zip(figures(RANK.sub("", shown)), figures(RANK.sub("", real)), strict=True):
        assert one == pytest.approx(other, rel=0.1, abs=3e-4)


def test_a_line_that_is_not_said_is_seen() -> None:
    assert_shown("a 1.50\nb", "x\na 1.51\nb\n")
    assert_shown("b (p = 0.09)", "b (p = 0.12)")
    for shown in ("a 1.50\nc", "a 2.50\nb", "b\na 1.50", "b (p = 0.2)"):
        with pytest.raises(AssertionError):
            assert_shown(shown, "x\na 1.51\nb\nb (p = 0.09)")


def test_every_page_of_a_readers_own_files_is_run() -> None:
    assert set(STAND_FOR) <= {page.stem for page in RUN}


OPTIONS = {
    name: {option for parameter in command.params for option in (*parameter.opts, *parameter.secondary_opts)}
    for name, command in typer.main.get_command(app).commands.items()  # type: ignore[attr-defined]
}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_options_in_running_text_are_the_commands(page: Path) -> None:
    """Of each ``halltwin COMMAND ...`` between single backticks."""
    for text in re.findall(r"`halltwin ([^`]+)`", " ".join(page.read_text(encoding="utf-8").split())):
        command, *rest = shlex.split(text.replace("'", ""))
        if command in OPTIONS:
            named = {word.split("=")[0] for word in rest if word.startswith("-") and not word[1:2].isdigit()}
            assert named <= OPTIONS[command] | {"-h", "--help"}, text
