"""A study's folder: what a killed run leaves is gone on with, one command at a time, and nothing of the user's goes."""

from __future__ import annotations

import errno
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scenarios.studies import study_folder
from tests.scenarios.study_jobs import CHUNKS, content, study
from twin.errors import UserError

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def calm(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What an undisturbed run leaves."""
    return content(study(tmp_path_factory.mktemp("study") / "calm").path)


def started(path: Path, pause_s: float = 0.3) -> subprocess.Popen[str]:
    """A study in a process group of its own, once its first chunk is complete."""
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.scenarios.study_jobs", str(path), str(pause_s)],
        cwd=ROOT,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    end = time.monotonic() + 60.0
    while not any((path / "done").glob("0*")):
        assert time.monotonic() < end
        assert process.poll() is None
        time.sleep(0.01)
    return process


@pytest.mark.parametrize(
    "left",
    [
        (),
        ("study.lock",),
        ("done/",),
        ("done/", "study.lock", ".halltwin-0123456789abcdef.part"),
        (".halltwin-0123456789abcdef.part/", ".halltwin-0123456789abcdef.part/half"),
    ],
    ids=str,
)
def test_a_folder_that_was_hardly_begun_is_gone_on_with(
    tmp_path: Path, left: tuple[str, ...], calm: dict[str, bytes]
) -> None:
    (tmp_path / "s").mkdir()
    for name in left:
        (tmp_path / "s" / name).mkdir() if name.endswith("/") else (tmp_path / "s" / name).touch()
    study(tmp_path / "s")
    assert content(tmp_path / "s") == calm


def test_only_what_is_surely_left_half_written_is_taken_away(tmp_path: Path) -> None:
    folder = study(tmp_path / "s").path
    own = ("chunks/.halltwin-0123456789abcdef.part", "done/.halltwin-fedcba9876543210.part")
    mine = (
        "thesis.partial",
        "chunks/.halltwin-notes.part",
        "chunks/0.abc.partial",
        ".notes.part",
        "a/.halltwin-0123456789abcdef.part",
    )
    (folder / "a").mkdir()
    for name in (*own, *mine):
        (folder / name).write_bytes(b"half")
    study(folder)
    assert set(own).isdisjoint(content(folder))
    assert set(mine) <= set(content(folder))


@pytest.mark.parametrize("damage", [b"", b"half a chunk", None], ids=["empty", "garbage", "gone"])
@pytest.mark.parametrize("name", ["chunks/000004.npz", "done/000004"])
def test_a_damaged_chunk_is_computed_anew(tmp_path: Path, damage: bytes | None, name: str) -> None:
    folder = study(tmp_path / "s").path
    before = content(folder)
    untouched = (folder / "chunks" / "000003.npz").stat().st_mtime_ns
    (folder / name).unlink()
    if damage is not None:
        (folder / name).write_bytes(damage)
    study(folder)
    assert content(folder) == before
    assert (folder / "chunks" / "000003.npz").stat().st_mtime_ns == untouched


def test_a_chunk_damaged_while_it_is_used_is_one_line(tmp_path: Path) -> None:
    folder = study(tmp_path / "s")
    (folder.path / "chunks" / "000004.npz").write_bytes(b"PK\x03\x04 half")
    with pytest.raises(UserError, match=r"000004\.npz: cannot be read .* the same command again"):
        folder.load(CHUNKS)


def test_other_settings_are_taken_up_as_long_as_nothing_is_complete(tmp_path: Path) -> None:
    folder = study(tmp_path / "s", seed=3)
    shutil.rmtree(folder.path / "done")
    study(tmp_path / "s", seed=5)
    study(tmp_path / "calm", seed=5)
    assert content(tmp_path / "s") == content(tmp_path / "calm")
    with pytest.raises(UserError, match="begun with seed 5, this run has 3"):
        study(tmp_path / "s", seed=3)


def test_a_second_command_in_the_folder_is_refused_until_the_first_is_gone(
    tmp_path: Path, calm: dict[str, bytes]
) -> None:
    first = started(tmp_path / "s")
    with pytest.raises(UserError, match="another halltwin is at work in this folder"):
        study(tmp_path / "s")
    # Its worker is left alone with half a chunk: that one must hold nothing, and not disturb what follows.
    os.kill(first.pid, signal.SIGKILL)
    first.wait()
    study(tmp_path / "s")
    assert content(tmp_path / "s") == calm


def test_ctrl_c_says_how_to_go_on_and_loses_nothing(tmp_path: Path, calm: dict[str, bytes]) -> None:
    first = started(tmp_path / "s", pause_s=0.5)
    # As a terminal does: to every process of the group.
    os.killpg(first.pid, signal.SIGINT)
    _, said = first.communicate(timeout=30.0)
    assert first.returncode == 130
    assert said.count("\n") == 1
    assert "complete chunks are kept" in said
    assert "run the same command again to go on" in said
    assert not list((tmp_path / "s").rglob(".halltwin-*"))
    study(tmp_path / "s")
    assert content(tmp_path / "s") == calm


def test_a_disk_full_at_the_very_start_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, content: bytes) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(study_folder, "write_whole", full)
    with pytest.raises(UserError, match=r"study\.json: cannot be written .* make room and run the same command again"):
        study(tmp_path / "s")
    assert not (tmp_path / "s").exists()
