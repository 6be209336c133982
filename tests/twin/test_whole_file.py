"""Files written whole or not at all: what stays when it fails, permissions, links, devices, unforeseeable names."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from twin import whole_file
from twin.errors import UserError
from twin.whole_file import check_writable, write_beside, write_together


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "there.txt").write_bytes(b"before")
    return tmp_path


def fail_at(monkeypatch: pytest.MonkeyPatch, name: str, *, call: int) -> None:
    """Let a function of ``os`` fail at one of its calls."""
    calls = []
    real = getattr(os, name)

    def failing(*given: object, **named: object) -> object:
        calls.append(given)
        if len(calls) == call:
            raise OSError(28, "No space left on device")
        return real(*given, **named)

    monkeypatch.setattr(whole_file.os, name, failing)


@pytest.mark.parametrize("function", ["fsync", "replace"])
@pytest.mark.parametrize("call", [1, 2, 3])
def test_of_several_files_all_are_written_or_none(
    function: str, call: int, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "too.txt").write_bytes(b"too")
    fail_at(monkeypatch, function, call=call)
    with pytest.raises(UserError, match="No space left on device"):
        write_together({folder / name: b"after" for name in ("there.txt", "new.txt", "too.txt")})
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == {"there.txt": b"before", "too.txt": b"too"}


def test_several_files_without_hard_links(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_link(*_: object) -> None:
        raise OSError(95, "Operation not supported")

    monkeypatch.setattr(whole_file.os, "link", no_link)
    write_together({folder / "there.txt": b"after", folder / "new.txt": b"new"})
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == {"there.txt": b"after", "new.txt": b"new"}


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
def test_a_file_keeps_its_permissions(mode: int, folder: Path) -> None:
    path = folder / "there.txt"
    path.chmod(mode)
    write_beside(path, b"after")
    assert stat.S_IMODE(path.stat().st_mode) == mode
    assert path.read_bytes() == b"after"


def test_a_new_file_has_the_permissions_that_the_umask_leaves(folder: Path) -> None:
    before = os.umask(0o027)
    try:
        write_beside(folder / "new.txt", b"new")
    finally:
        os.umask(before)
    assert stat.S_IMODE((folder / "new.txt").stat().st_mode) == 0o640


def test_nobody_else_can_read_a_secret_while_it_is_written(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = folder / "there.txt"
    path.chmod(0o600)
    seen = []
    real = os.fsync
    monkeypatch.setattr(whole_file.os, "fsync", lambda n: (seen.append(stat.S_IMODE(os.fstat(n).st_mode)), real(n)))
    write_beside(path, b"after")
    assert seen == [0o600]


def test_a_link_stays_and_what_it_leads_to_is_replaced(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "elsewhere").mkdir()
    link, dangling = folder / "link", folder / "dangling"
    link.symlink_to("there.txt")
    dangling.symlink_to(folder / "elsewhere" / "new.txt")
    write_beside(link, b"after")
    write_beside(dangling, b"new")
    assert link.is_symlink()
    assert (folder / "there.txt").read_bytes() == b"after"
    assert (folder / "elsewhere" / "new.txt").read_bytes() == b"new"
    fail_at(monkeypatch, "fsync", call=1)
    with pytest.raises(UserError):
        write_beside(link, b"too long for the disk")
    assert link.read_bytes() == b"after"


def test_a_disk_that_fills_up_takes_nothing_away(folder: Path) -> None:
    """Files can be no longer than so many bytes, as on a disk with no more room: of several, also behind a link."""
    (folder / "link").symlink_to("there.txt")
    code = (
        "import resource, sys; from pathlib import Path; from twin.whole_file import write_together\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))\n"
        "write_together({Path('new.txt'): b'new', Path('link'): b'x' * 5001})"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    ended = subprocess.run([sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, check=False)
    assert b"link: cannot be written (File too large)" in ended.stderr
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == {"there.txt": b"before", "link": b"before"}


def test_names_cannot_be_foreseen_and_a_planted_link_is_not_followed(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = {whole_file.new_name(folder / "there.txt").name for _ in range(100)}
    assert len(names) == 100
    # Even where someone knows the name.
    planted = folder / ".halltwin-known.part"
    planted.symlink_to(folder / "victim.txt")
    monkeypatch.setattr(whole_file.secrets, "token_hex", lambda _: "known")
    with pytest.raises(UserError, match="exists"):
        write_beside(folder / "there.txt", b"after")
    assert not (folder / "victim.txt").exists()
    assert (folder / "there.txt").read_bytes() == b"before"


def test_what_cannot_be_written_is_said_beforehand(folder: Path) -> None:
    (folder / "loop").symlink_to("loop")
    for name, said in {"": "is a folder", "no/x": "there is no folder", "loop": "link", "n" * 300: "too long"}.items():
        with pytest.raises(UserError, match=said):
            check_writable(folder / name)
    with pytest.raises(UserError, match="there is no folder"):
        check_writable(folder / "there.txt" / "x")


@pytest.mark.skipif(os.geteuid() == 0, reason="the administrator may write everywhere")
def test_read_only_is_said_beforehand(folder: Path) -> None:
    (folder / "there.txt").chmod(0o444)
    with pytest.raises(UserError, match="no permission"):
        check_writable(folder / "there.txt")
    folder.chmod(0o555)
    with pytest.raises(UserError, match="no permission"):
        check_writable(folder / "new.txt")


def test_pipes_and_the_own_output_are_written_to_as_they_are(folder: Path) -> None:
    pipe = folder / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_beside(pipe, b"through")
    assert os.read(reader, 100) == b"through"
    os.close(reader)
    code = (
        "from pathlib import Path; from twin.whole_file import write_beside\n"
        "print('printed'); write_beside(Path('/dev/stdout'), b'written\\n'); print('more')"
    )
    with (folder / "out.txt").open("wb") as out:
        subprocess.run([sys.executable, "-c", code], stdout=out, check=True)
    assert (folder / "out.txt").read_text() == "printed\nwritten\nmore\n"
