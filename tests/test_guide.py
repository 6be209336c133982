"""What the guide shows is what the program says, and its links lead somewhere."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from diagnosis.correction.targets.known import TARGETS
from scenarios.cli.app import app
from scenarios.commands.protocol import Protocol
from tests.command_line import halltwin
from tests.pages import GUIDE, PAGES, ROOT, block, figures, lines, part, words
from twin.angles import wrap
from twin.files import from_dict, to_dict
from twin.hardware import run

OWN_PAGE = GUIDE / "own_effects.md"
OWN = ROOT / "scenarios/data/gear_mesh.py"
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


def test_catalogue_is_the_generated_one() -> None:
    assert lines(part(GUIDE / "catalogue.md", "catalogue")) == lines(halltwin("causes", "--markdown").out)


@pytest.mark.parametrize(("name", "options"), [("unnamed", ()), ("named", ("--effects", OWN))])
def test_own_effect_is_its_real_output(
    name: str, options: tuple[str | Path, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The table of causes as it stands in the output, and its figures to a few percent."""
    monkeypatch.setenv("COLUMNS", "100")
    shown, out = block(OWN_PAGE, name), halltwin("explain", ROOT / "scenarios/data/gear_sweep.csv", *options).out
    out = out.rstrip()
    # lines() strips blanks at both ends of a text, so the first line's own are put aside.
    wanted, said = words(shown), words(out)
    wanted[0] = next(line for line in said if line.strip() == wanted[0])
    start = said.index(wanted[0])
    assert said[start : start + len(wanted)] == wanted
    real = "\n".join(lines(out)[start : start + len(wanted)])
    for told, found in zip(figures(shown), figures(real), strict=True):
        assert told == pytest.approx(found, rel=0.03, abs=3e-4)


def test_drives_of_the_page_are_those_of_the_command() -> None:
    page = (GUIDE / "drive_tables.md").read_text(encoding="utf-8")
    assert TARGETS
    for target in TARGETS:
        assert f"| `{target.name}` |" in page


@pytest.mark.parametrize(
    ("name", "path"), [("own", OWN), ("thermal_zero_shift", ROOT / "twin/mechanics/thermal_zero_shift.py")]
)
def test_shown_declaration_is_the_shipped_file(name: str, path: Path) -> None:
    assert path.read_text(encoding="utf-8").endswith(f"\n{block(OWN_PAGE, name, 'python')}\n")
    assert "import" not in block(OWN_PAGE, name, "python")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    """To a file of the repository and, where one is named, to a heading of it; to the web only over https."""
    for target in LINK.findall(page.read_text(encoding="utf-8")):
        if ":" in target:
            assert target.startswith("https://"), target
            continue
        name, _, heading = target.partition("#")
        path = (page.parent / name).resolve() if name else page
        assert path.is_relative_to(ROOT), target
        assert path.exists(), target
        if heading:
            assert heading in {anchor(line) for line in path.read_text(encoding="utf-8").splitlines()}, target


def anchor(line: str) -> str:
    """The anchor that a Markdown heading gets on the usual hosts; "" for other lines."""
    if not line.startswith("#"):
        return ""
    return re.sub(r"[^\w\- ]", "", line.lstrip("#").strip().lower()).replace(" ", "-")


def test_index_lists_every_page() -> None:
    listed = set(LINK.findall((GUIDE / "index.md").read_text(encoding="utf-8")))
    assert {page.name for page in GUIDE.glob("*.md")} - {"index.md"} <= listed


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_of_the_figures_exist(page: Path) -> None:
    """Every ``python -m`` that a page names is a module of this repository."""
    for module in re.findall(r"python -m ([\w.]+)", page.read_text(encoding="utf-8")):
        path = ROOT / module.replace(".", "/")
        assert module == "venv" or path.with_suffix(".py").is_file() or (path / "__main__.py").is_file(), module


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_that_pages_name_exist(page: Path) -> None:
    """Names in capitals stand for one of the reader's own."""
    for name in re.findall(r"`((?:twin|diagnosis|scenarios|tests)/[^`\s]*)`", page.read_text(encoding="utf-8")):
        assert re.search(r"\b[A-Z]{4,}\b", name) or (ROOT / name).exists(), name


def test_folders_of_the_architecture_exist() -> None:
    """Each line of the tree belongs to the package above it; what ends in / or .py is somewhere in there."""
    tree = re.search("```\n(.*?)```", (GUIDE / "architecture.md").read_text(encoding="utf-8"), re.S)
    assert tree
    package = ROOT
    for line in tree[1].splitlines():
        if not line.startswith(" "):
            package = ROOT / line.split("/")[0]
        for name in re.findall(r"(?:^|\s)(\w+(?:/|\.py))(?=\s|$|,)", line):
            assert package.name == name.rstrip("/") or any(package.rglob(name.rstrip("/"))), f"{package.name}: {name}"


def test_commands_that_pages_name_exist() -> None:
    known = {command.name or command.callback.__name__.replace("_", "-") for command in app.registered_commands}
    for page in PAGES:
        named = set(re.findall(r"halltwin ([a-z][a-z-]+)", page.read_text(encoding="utf-8")))
        assert named <= known, page.name


def test_how_it_works_lists_every_stage_in_order() -> None:
    page = (GUIDE / "how_it_works.md").read_text(encoding="utf-8")
    source = (ROOT / "diagnosis/discovery/pipeline.py").read_text(encoding="utf-8")
    listed = re.search(r"^PIPELINE.*?^\)$", source, re.S | re.M)
    assert listed
    stages = {path.stem for path in (ROOT / "diagnosis/discovery/stages").glob("[!_]*.py")}
    order = [name for name in re.findall(r"^\s+(\w+),", listed[0], re.M) if name in stages]
    assert set(order) == stages
    assert [name for name in re.findall(r"^\| `(\w+)` \|", page, re.M) if name in stages] == order


def test_the_twin_of_its_page_is_read_run_and_written() -> None:
    chain = from_dict(tomllib.loads(block(GUIDE / "twin.md", "twin", "toml")))
    assert [part.name for part in chain.described] == ["disk", "plates", "sampling", "converter"]
    motion = Protocol().motion()
    signals = run(chain, motion, np.random.default_rng(1))
    recorded = np.radians(chain.simulate(motion, seed=1).measured_deg)
    assert np.max(np.abs(wrap(signals.received_rad - recorded))) < 1e-6
    assert to_dict(from_dict(to_dict(chain))) == to_dict(chain)
