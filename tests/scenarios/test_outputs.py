"""The one rule for what commands write: each command, each of its outputs, each way to lose a file by it."""

from __future__ import annotations

import csv
import inspect
import os
import re
import shutil
import stat
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, get_args, get_type_hints

import numpy as np
import pytest
import typer

from scenarios.cli import app as command_line
from scenarios.commands.marks import is_own
from scenarios.commands.paper import run as paper
from tests.command_line import csv_text, halltwin, sweep_angles
from twin.whole_file import TEMPORARY

COMMANDS, COMMAND_LINE = command_line.app.registered_commands, typer.main.get_command(command_line.app)
FOREIGN = b"time_s,reference_deg,measured_deg\n0,1,2\n# somebody's own\n"


@dataclass(frozen=True)
class Case:
    """A command with what it reads, and the name of each file that it writes by the option that asks for it."""

    reads: tuple[str, ...] = ()
    outputs: dict[str, str] = field(default_factory=dict)
    inputs: tuple[str, ...] = ()
    folder: tuple[str, ...] = ()

    @property
    def told(self) -> str:
        """What the command says that it wrote."""
        return ", ".join(self.outputs.values()) or f"{', '.join(self.folder)} to out"

    @property
    def written(self) -> dict[str, str]:
        """Option -> file, or the file itself where the option names a folder."""
        return self.outputs or {name: f"out/{name}" for name in self.folder}


CASES = {
    "explain": Case(
        ("sweep.csv", "--twin", "twin.toml", "--effects", "own.py"),
        {"--json": "a.json", "--report": "a.html", "--extended": "a.toml", "--plot": "a.png"},
        ("sweep.csv", "twin.toml", "own.py"),
    ),
    "diagnose": Case(
        ("sweeps", "sweep.csv"),
        {"--json": "a.json", "--plot": "a.svg", "--convergence": "a.pdf"},
        ("sweeps/one.csv", "sweep.csv"),
    ),
    "compensate": Case(
        ("sweep.csv", "--check", "sweeps"),
        {"--header": "a.h", "--table": "a.csv.gz", "--toml": "a.toml", "--plot": "a.png"},
        ("sweep.csv", "sweeps/one.csv"),
    ),
    "export": Case(("sweep.csv", "--for=lut"), {"-o": "a.csv", "--json": "a.json", "--plot": "a.png"}, ("sweep.csv",)),
    "import": Case(("sweep.csv",), {"-o": "a.csv"}, ("sweep.csv",)),
    "doctor": Case(("sweep.csv",), {"--json": "a.json"}, ("sweep.csv",)),
    "monitor": Case(("series.csv",), {"--json": "a.json", "--plot": "a.png"}, ("series.csv",)),
    "simulate": Case(
        ("twin.toml", "--motion", "sweep.csv", "--effects", "own.py"),
        {"-o": "a.csv", "--trace": "b.csv", "--plot": "a.png"},
        ("twin.toml", "sweep.csv", "own.py"),
    ),
    "hardware": Case(("twin.toml",), folder=("hardware.csv", "hardware.png", "hardware.svg")),
    "spinning": Case(folder=("spinning.csv", "spinning.png", "spinning.svg")),
    "paper": Case(folder=("table1.csv", "fig3.csv", "fig3.svg", "fig3.png")),
    "new-effect": Case(("gear_mesh", "--from", "answer.json"), {"-o": "a.py"}, ("answer.json",)),
}
READ = {"twin", "motion", "effects", "answer", "replay"}
"""Options that name what is read."""
EACH = [(command, option) for command, case in CASES.items() for option in case.written]
NAMED = [(command, option) for command, case in CASES.items() for option in case.outputs]


@pytest.fixture(scope="module")
def read(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with all that the commands read."""
    folder = tmp_path_factory.mktemp("read")
    (folder / "sweeps").mkdir()
    reference = np.arange(0.0, 720.0, 8.0)
    columns = {"time_s": np.arange(reference.size) * 0.5, "reference_deg": reference % 360.0}
    text = csv_text({**columns, "measured_deg": sweep_angles(reference)})
    for name in ("sweep.csv", "sweeps/one.csv"):
        (folder / name).write_text(text)
    series = ("-o", folder / "series.csv", "--turns", "5", "--points", "36", "--no-channels")
    assert halltwin("simulate", "paper-encoder", *series).code == 0
    assert halltwin("new-effect", "own_cause", "-o", folder / "own.py").code == 0
    (folder / "twin.toml").write_text('schema = "halltwin.twin/1"\n[effects.noise]\nrms_deg = 0.02\n')
    (folder / "answer.json").write_text("{}")
    return folder


@pytest.fixture(autouse=True)
def folder(read: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of what the commands read, which is also where they run."""
    shutil.copytree(read, tmp_path, dirs_exist_ok=True)
    monkeypatch.setattr(paper, "FIGURES", {"fig3": paper.FIGURES["fig3"]})
    monkeypatch.setattr(paper, "TABLES", {"table1": paper.TABLES["table1"]})
    # Built once: building it takes longer than a refusal.
    monkeypatch.setattr(command_line, "app", COMMAND_LINE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def keeps_attributes(folder: Path) -> bool:
    """Whether the system and the disk keep extended attributes of files."""
    probe = folder / "probe"
    probe.touch()
    try:
        os.setxattr(probe, "user.probe", b"1")
    except (AttributeError, OSError):
        return False
    finally:
        probe.unlink()
    return True


def ask(command: str, outputs: dict[str, str | Path], *more: str) -> Any:
    """Run the command with these outputs in place of the case's own; a folder's are asked for all at once."""
    case = CASES[command]
    named = case.outputs | outputs if case.outputs else {"-o": outputs.get("-o", "out")}
    options = [str(part) for pair in named.items() for part in pair]
    return halltwin(command, *case.reads, *options, *more)


def snapshot(folder: Path) -> dict[str, tuple[bytes, int, bool]]:
    """Every file with its content, its number on the disk, and whether it is a link."""
    return {
        str(path.relative_to(folder)): (path.read_bytes(), path.stat().st_ino, path.is_symlink())
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.fixture
def refused(folder: Path) -> Callable[..., str]:
    """Ask a command that must refuse in one line, having changed nothing."""

    def asked(command: str, outputs: dict[str, str | Path], *more: str) -> str:
        before = snapshot(folder)
        ended = ask(command, outputs, *more)
        assert (ended.code, ended.out, ended.err.count("\n")) == (2, "", 1), ended
        assert snapshot(folder) == before
        return str(ended.err)

    return asked


@pytest.fixture
def open_as() -> Iterator[Callable[[str], str]]:
    """Open a file for reading and writing, and give its name by number."""
    if not Path("/proc/self/fd").exists():
        pytest.skip("the system gives open files no names")
    numbers = []

    def opened(name: str) -> str:
        numbers.append(os.open(name, os.O_RDWR | os.O_CREAT))
        return f"/proc/self/fd/{numbers[-1]}"

    yield opened
    for number in numbers:
        os.close(number)


def make_read_only(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Let the folders of this name be closed to writing, also for the superuser."""
    access = os.access

    def closed(path: str | Path, mode: int) -> bool:
        return access(path, mode) and not (Path(path).name == name and mode & os.W_OK)

    monkeypatch.setattr(os, "access", closed)


# ---- the walk ---------------------------------------------------------------------------------------------------


def paths_of(callback: Callable[..., Any]) -> set[str]:
    """The options of a command that name a file or folder."""
    hints = get_type_hints(callback, include_extras=True)
    found = set()
    for name in inspect.signature(callback).parameters:
        kind, *extras = get_args(hints[name]) or (hints[name],)
        is_option = any(isinstance(extra, typer.models.OptionInfo) for extra in extras)
        if is_option and (kind is Path or Path in {*get_args(kind), *(a for k in get_args(kind) for a in get_args(k))}):
            found.add(name)
    return found - READ


def test_every_command_that_writes_has_force_and_is_in_the_table() -> None:
    for command in COMMANDS:
        assert command.callback is not None
        name = command.name or command.callback.__name__.replace("_", "-")
        writes = paths_of(command.callback)
        # What it leaves beside its store is read by nobody but itself.
        if not writes or name == "generate":
            continue
        assert "force" in inspect.signature(command.callback).parameters, name
        # Their files have tests of their own.
        if name in ("bench", "design", "recover", "fleet", "guide"):
            continue
        asked = {"output" if option == "-o" else option.removeprefix("--") for option in CASES[name].outputs}
        assert writes == (asked or {"output"}), name


# ---- what is refused --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("command", "option"), EACH)
def test_a_file_of_somebody_else_stays(command: str, option: str, folder: Path, refused: Callable[..., str]) -> None:
    path = folder / CASES[command].written[option]
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(FOREIGN)
    assert "--force" in refused(command, {})


@pytest.mark.parametrize(("command", "option"), NAMED)
@pytest.mark.parametrize("spelling", ["plain", "dots", "link", "hard link"])
def test_an_input_stays(command: str, option: str, spelling: str, folder: Path, refused: Callable[..., str]) -> None:
    for name in CASES[command].inputs:
        given = {
            "plain": folder / name,
            "dots": folder / "sweeps" / ".." / name,
            "link": folder / f"link{CASES[command].outputs[option]}",
            "hard link": folder / f"hard{CASES[command].outputs[option]}",
        }[spelling]
        given.unlink(missing_ok=True) if "link" in spelling else None
        if spelling == "link":
            given.symlink_to(name)
        elif spelling == "hard link":
            os.link(folder / name, given)
        assert "read or written already" in refused(command, {option: given}, "--force")


@pytest.mark.parametrize(("command", "option"), NAMED)
def test_an_input_that_is_open_stays(
    command: str, option: str, folder: Path, refused: Callable[..., str], open_as: Callable[[str], str]
) -> None:
    """By the number under which a shell has opened it (``5<>sweep.csv``)."""
    for name in CASES[command].inputs:
        assert "read or written already" in refused(command, {option: open_as(name)}, "--force")


def test_an_open_file_of_somebody_else_stays(
    folder: Path, refused: Callable[..., str], open_as: Callable[[str], str]
) -> None:
    (folder / "log.txt").write_text("somebody's own")
    name = open_as("log.txt")
    assert "--force" in refused("simulate", {"-o": name})
    assert halltwin("simulate", "-o", open_as("empty")).code == 0
    assert (folder / "empty").read_text().startswith("time_s,")
    # What is open is written behind what it holds.
    assert halltwin("simulate", "-o", name, "--force").code == 0
    assert (folder / "log.txt").read_text().startswith("somebody's owntime_s,")


def test_two_names_of_one_open_file_are_one(
    folder: Path, refused: Callable[..., str], open_as: Callable[[str], str]
) -> None:
    one, other = open_as("empty"), open_as("empty")
    assert "read or written already" in refused("simulate", {"-o": one, "--trace": other}, "--force")


@pytest.mark.parametrize(("command", "option"), NAMED)
def test_an_output_is_no_other(command: str, option: str, folder: Path, refused: Callable[..., str]) -> None:
    outputs = CASES[command].outputs
    (folder / "link").symlink_to(folder / "sweeps")
    for other in outputs.keys() - {option}:
        for name in ("sweeps/x.csv", "sweeps/X.CSV", "sweeps/../sweeps/x.csv", "link/x.csv"):
            asked = {other: "sweeps/x.csv", option: name}
            assert "read or written already" in refused(command, asked, "--force")


@pytest.mark.parametrize(("command", "option"), NAMED)
def test_a_place_where_nothing_can_be_written(
    command: str, option: str, folder: Path, refused: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    name = CASES[command].outputs[option]
    (folder / "loop").symlink_to("loop")
    places = {f"no/{name}": "no folder", "sweeps": "is a folder", f"sweep.csv/{name}": "no folder", "loop": "link"}
    for place, words in places.items():
        assert words in refused(command, {option: place}, "--force")
    assert " end in " in refused(command, {option: "a.txt"}, "--force")
    make_read_only(monkeypatch, "sweeps")
    assert "no permission" in refused(command, {option: f"sweeps/{name}"}, "--force")


@pytest.mark.parametrize("command", [name for name, case in CASES.items() if case.folder])
def test_a_folder_that_cannot_be_one(
    command: str, folder: Path, refused: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for place in ("sweep.csv", "sweep.csv/deeper"):
        assert "is a file; several files are written: give the name of a folder" in refused(command, {"-o": place})
    for place in ("turn.png", "deeper/TURN.CSV", ".svg"):
        assert "is named like a file" in refused(command, {"-o": place}, "--force")
    make_read_only(monkeypatch, "sweeps")
    for place in ("sweeps", "sweeps/new/deeper"):
        assert "no permission" in refused(command, {"-o": place}, "--force")


# ---- what is written --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", [name for name in CASES if name != "new-effect"])
def test_own_files_are_known_and_edited_ones_are_not(command: str, folder: Path, refused: Callable[..., str]) -> None:
    ended = ask(command, {})
    assert ended.code == 0
    names = CASES[command].written.values()
    (told,) = (line for line in ended.out.splitlines() if line.startswith("wrote "))
    assert re.sub(r" \(.*?\)", "", told) == f"wrote {CASES[command].told}"
    written = [folder / name for name in names]
    for path in written:
        if path.suffix in (".csv", ".gz") and not keeps_attributes(folder):
            assert not is_own(path)
            continue
        assert is_own(path)
        content = path.read_bytes()
        for edited in (content[:-9] + b" " + content[-9:], content.replace(b"0", b"1", 1), content + b"\n"):
            path.write_bytes(edited)
            assert "--force" in refused(command, {})
        path.write_bytes(content)
    assert list(folder.rglob(TEMPORARY)) == []


def test_a_sweep_is_plain_csv(folder: Path) -> None:
    """Its first line is the header, for readers that know no comments."""
    assert halltwin("simulate", "paper-encoder", "-o", "plain.csv").code == 0
    with open("plain.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 360
    assert all(abs(float(row["reference_deg"])) <= 360.0 for row in rows)


def test_a_copy_that_lost_its_mark_is_the_users(folder: Path) -> None:
    assert halltwin("simulate", "paper-encoder", "-o", "plain.csv").code == 0
    content = Path("plain.csv").read_bytes()
    Path("plain.csv").unlink()
    Path("plain.csv").write_bytes(content)
    assert halltwin("simulate", "paper-encoder", "-o", "plain.csv").code == 2
    assert Path("plain.csv").read_bytes() == content


@pytest.mark.parametrize("command", ["simulate", "compensate"])
def test_replaced_files_keep_permissions_and_links(command: str, folder: Path) -> None:
    """And are the same bytes again."""
    assert ask(command, {}).code == 0
    written = [folder / name for name in CASES[command].written.values()]
    first = {path: path.read_bytes() for path in written}
    for path in written:
        path.chmod(0o600)
    away = folder / f"away{written[0].suffix}"
    written[0].rename(away)
    written[0].symlink_to(away)
    assert ask(command, {}).code == 0
    assert {path: path.read_bytes() for path in written} == first
    assert written[0].is_symlink()
    assert {stat.S_IMODE(path.stat().st_mode) for path in written} == {0o600}
    written[1].write_bytes(FOREIGN)
    assert ask(command, {}, "--force").code == 0
    assert written[1].read_bytes() == first[written[1]]


def test_a_skeleton_is_never_the_programs_own(folder: Path, refused: Callable[..., str]) -> None:
    (folder / "answer.json").unlink()
    for code, more in ((0, []), (2, []), (0, ["--force"])):
        assert halltwin("new-effect", "gear_mesh", "-o", "a.py", *more).code == code


def test_an_empty_file_holds_nothing_to_lose(folder: Path) -> None:
    (folder / "a.csv").touch()
    assert halltwin("simulate", "-o", "a.csv").code == 0


def test_nothing_is_written_where_the_last_file_fails(folder: Path, refused: Callable[..., str]) -> None:
    """A file of somebody else's appears while the command works."""
    from unittest import mock

    from twin.chain import Chain

    simulate = Chain.simulate

    def slow(*given: Any, **named: Any) -> Any:
        (folder / "b.csv").write_bytes(FOREIGN)
        return simulate(*given, **named)

    with mock.patch.object(Chain, "simulate", slow):
        assert ask("simulate", {}).code == 2
    assert (folder / "b.csv").read_bytes() == FOREIGN
    assert not (folder / "a.csv").exists()
