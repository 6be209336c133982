"""The newcomer's path as the guide has it: from ``pip install`` to a magnet chosen and a sweep explained.

The program is installed from the checkout into an environment of its own, which borrows what it depends on from this
one, and runs in an empty folder: what the page and its help need must have come with it.
"""

from __future__ import annotations

import contextlib
import os
import shlex
import shutil
import signal
import subprocess
import sysconfig
import venv
from collections.abc import Iterator
from pathlib import Path

import pytest

from scenarios.lab.command import started
from tests.pages import ROOT
from tests.scenarios.lab import pictures
from tests.scenarios.lab.browser import BROWSER, WHY_SKIPPED, Page, browsing, complaints, file_in, opened
from tests.scenarios.lab.pictures import DATA

pytestmark = pytest.mark.skipif(BROWSER is None, reason=WHY_SKIPPED)
BUILT_FROM = ("pyproject.toml", "README.md", "LICENSE", "twin", "diagnosis", "scenarios")


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the commands of an environment into which the checkout was installed."""
    folder = tmp_path_factory.mktemp("installed")
    checkout = folder / "checkout"
    checkout.mkdir()
    for name in BUILT_FROM:
        copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
        copy(ROOT / name, checkout / name)
    venv.create(folder / "venv", with_pip=True)
    commands = folder / "venv" / "bin"
    asked = [commands / "pip", "install", "-q", "--no-deps", "--disable-pip-version-check", checkout]
    ended = subprocess.run(asked, capture_output=True, text=True, env=_plain(), timeout=300)
    if ended.returncode and "No matching distribution found for setuptools" in ended.stderr:
        pytest.skip("no network here: pip cannot fetch what builds the project")
    assert ended.returncode == 0, ended.stderr
    places = dict.fromkeys(sysconfig.get_path(name) for name in ("purelib", "platlib"))
    (own,) = (folder / "venv" / "lib").glob("python*/site-packages")
    (own / "borrowed.pth").write_text("\n".join(map(str, places)) + "\n")
    return commands


def _plain() -> dict[str, str]:
    """The surroundings without a way to the checkout."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


@contextlib.contextmanager
def lab(commands: Path, folder: Path) -> Iterator[str]:
    """The page, served by the installed command from an empty folder, until Ctrl-C."""
    asked = [commands / "halltwin", "lab", "--no-browser"]
    served = subprocess.Popen(asked, cwd=folder, env=_plain(), stdout=subprocess.PIPE, text=True)
    try:
        assert served.stdout is not None
        line = served.stdout.readline()
        assert line.startswith("the page is at http://127.0.0.1:"), line
        assert "Ctrl-C ends it" in served.stdout.readline()
        yield line.split()[-1]
        served.send_signal(signal.SIGINT)
        assert served.wait(30.0) == 0
    finally:
        if served.poll() is None:
            served.kill()
            served.wait()


def run(commands: Path, folder: Path, *words: str | Path) -> str:
    """What an installed command prints."""
    asked = [commands / "halltwin", *words]
    ended = subprocess.run(asked, cwd=folder, env=_plain(), capture_output=True, text=True, timeout=300)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def read_help(page: Page) -> None:
    """The view's page of the guide, as its link leads there."""
    target = page.of("document.querySelector('#design p.help a').href")
    here = page.of("location.href")
    page.call("Page.navigate", url=target)
    page.until("document.querySelector('h1')?.textContent === 'Choose a magnet'")
    page.call("Page.navigate", url=here)
    page.until("document.documentElement?.dataset.ready === 'yes'")


def test_from_nothing_to_an_answer(installed: Path, tmp_path: Path) -> None:
    work, saved = tmp_path / "work", tmp_path / "saved"
    for folder in (work, saved):
        folder.mkdir()
    asked = [installed / "python", "-c", "import twin; print(twin.__file__)"]
    origin = subprocess.run(asked, cwd=work, env=_plain(), capture_output=True, text=True, check=True).stdout
    assert origin.startswith(str(installed.parent))
    with lab(installed, work) as url, browsing(tmp_path) as browser:
        page = opened(browser, url, saved)
        pictures.begins(page, tmp_path)
        assert "in only 73.5 % of the mountings" in page.of("document.getElementById('verdict').textContent")
        read_help(page)
        page.until(pictures.AT_REST)
        pictures.chosen(page, tmp_path)
        command = page.of("document.getElementById('command').textContent")
        page.of("document.getElementById('save-twin').click()")
        (work / "mine.toml").write_bytes(file_in(saved, "twin.toml"))
        pictures.explains(page, tmp_path)
        page.of("document.getElementById('save-json').click()")
        answer = file_in(saved, "answer.json")
        # The same without the page.
        shutil.copy(DATA / "bench_sweep.csv", work)
        said = run(installed, work, "explain", "bench_sweep.csv", "--json", "answer.json", "--report", "report.html")
        pictures.installed(page, tmp_path, started(url))
        pictures.reported(page, tmp_path, work / "report.html")
        assert complaints(browser) == []
    for name in pictures.PICTURES:
        seen, kept = (folder / name for folder in (tmp_path, DATA))
        # The size in the head of a PNG: the picture of the guide is one of this page.
        assert seen.read_bytes()[16:24] == kept.read_bytes()[16:24]
        assert seen.stat().st_size == pytest.approx(kept.stat().st_size, rel=0.25)
    assert "1  hysteresis" in said
    assert (work / "answer.json").read_bytes() == answer
    _, *words = shlex.split(command)
    assert " 100.0" in run(installed, work, *words, "-o", "design")
    assert "wrote expected.csv" in run(installed, work, "simulate", "mine.toml", "-o", "expected.csv")
    assert run(installed, work, "guide", "first_walk").startswith("# From nothing to an answer")
