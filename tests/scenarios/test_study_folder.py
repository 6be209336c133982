"""A study's folder: what a killed run leaves is gone on with, one command at a time, and nothing of the user's goes."""

from __future__ import annotations

import errno
import hashlib
import io
import os
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest

from scenarios.studies import study_folder
from scenarios.studies.study_folder import StudyFolder
from tests.scenarios.study_jobs import CHUNKS, content, identity, study
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


def forged(**arrays: object) -> bytes:
    """A chunk file with these arrays."""
    out = io.BytesIO()
    np.savez(out, **arrays)  # type: ignore[arg-type]
    return out.getvalue()


def bomb() -> bytes:
    """An archive of some kilobytes that says to hold more than any chunk does."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("value.npy", b"0" * 1000)
    size = (1000).to_bytes(4, "little")
    return out.getvalue().replace(size, b"\xf0\xff\xff\xff")


@pytest.mark.parametrize(
    ("chunk", "said"),
    [
        (b"PK\x03\x04 half", r"000004\.npz: cannot be read .* the same command again"),
        (b"", r"000004\.npz: cannot be read"),
        (forged(other=np.arange(3)), r"000004\.npz: does not hold the arrays of a chunk"),
        (forged(value=np.arange(3), other=np.arange(3)), r"000004\.npz: does not hold the arrays of a chunk"),
        (forged(value=np.float64(3)), r"000004\.npz: does not hold the arrays of a chunk"),
        (forged(value=np.zeros((3, 2))), r"000004\.npz: does not hold the arrays of a chunk"),
        (forged(value=np.array([{}], dtype=object)), r"000004\.npz: cannot be read"),
        (bomb(), r"000004\.npz: holds more than 2000 MB"),
    ],
)
def test_a_chunk_that_is_none_while_it_is_used_is_one_line(tmp_path: Path, chunk: bytes, said: str) -> None:
    folder = study(tmp_path / "s")
    (folder.path / "chunks" / "000004.npz").write_bytes(chunk)
    with pytest.raises(UserError, match=said):
        folder.load(CHUNKS)
    with pytest.raises(UserError, match=r"000000\.npz: does not hold the arrays of a chunk"):
        folder.load(3, ("value", "cell"))


def test_other_settings_are_taken_up_as_long_as_nothing_is_there(tmp_path: Path) -> None:
    with StudyFolder.opened(tmp_path / "s", identity(seed=3)) as folder, folder.workspace() as beside:
        (beside / "store").mkdir()
        (beside / "store" / "bare").write_text("a store without its chunks")
        folder.mark("store", folder.place("store", beside))
    with StudyFolder.opened(tmp_path / "s", identity(seed=4), stores=("store",)):
        assert not (tmp_path / "s" / "store").exists()
    study(tmp_path / "s", seed=5)
    study(tmp_path / "calm", seed=5)
    assert content(tmp_path / "s") == content(tmp_path / "calm")
    with pytest.raises(UserError, match="begun with --seed 5, now 3"):
        study(tmp_path / "s", seed=3)


@pytest.mark.parametrize("mine", [None, "chunks/thesis.txt", "done/notes", "chunks/a/b", "store/c"])
def test_nothing_that_no_mark_lists_goes_with_other_settings(tmp_path: Path, mine: str | None) -> None:
    if mine is None:
        # Chunks whose marks are lost may be anybody's.
        shutil.rmtree(study(tmp_path / "s").path / "done")
    else:
        with StudyFolder.opened(tmp_path / "s", identity()):
            (tmp_path / "s" / mine).parent.mkdir(parents=True)
            (tmp_path / "s" / mine).write_text("mine")
    before = content(tmp_path / "s")
    with (
        pytest.raises(UserError, match="begun with --seed 0, now 3; give another folder"),
        StudyFolder.opened(tmp_path / "s", identity(seed=3), stores=("store",)),
    ):
        pass
    assert content(tmp_path / "s") == before


def test_lost_marks_are_made_again_and_a_foreign_file_is_not_replaced(tmp_path: Path, calm: dict[str, bytes]) -> None:
    folder = study(tmp_path / "s").path
    shutil.rmtree(folder / "done")
    (folder / "chunks" / "000007.npz").write_bytes(b"")
    study(folder)
    assert content(folder) == calm
    shutil.rmtree(folder / "done")
    (folder / "chunks" / "000004.npz").write_text("mine")
    with pytest.raises(UserError, match=r"000004\.npz: was not written by this study; move it away"):
        study(folder)
    assert (folder / "chunks" / "000004.npz").read_text() == "mine"


@pytest.mark.parametrize("name", ["chunks/000004.npz", "done/000004", "study.json", "study.lock"])
@pytest.mark.parametrize("plant", ["/dev/zero", "mine", "nowhere", "pipe"])
def test_what_is_no_plain_file_is_neither_read_nor_followed(tmp_path: Path, name: str, plant: str) -> None:
    folder, mine = study(tmp_path / "s").path, tmp_path / "mine"
    mine.write_text("mine")
    place = folder / name
    place.unlink(missing_ok=True)
    os.mkfifo(place) if plant == "pipe" else place.symlink_to(tmp_path / plant)
    with pytest.raises(UserError, match=r"expected a plain file|is no study"):
        study(folder)
    assert mine.read_text() == "mine"
    assert not (tmp_path / "nowhere").exists()
    assert place.is_fifo() or place.is_symlink()


@pytest.mark.parametrize("name", ["../mine", "/{0}/mine", "chunks/../../mine"])
def test_a_mark_that_leads_out_of_the_folder_is_none(tmp_path: Path, name: str) -> None:
    (tmp_path / "mine").write_text("mine")
    told = f"{hashlib.sha256(b'mine').hexdigest()}  {name.format(tmp_path)}\n"
    with StudyFolder.opened(tmp_path / "s", identity()) as folder:
        folder.mark("store", [])
        (tmp_path / "s" / "done" / "store").write_text(told)
        assert folder.damaged("store") is None
    with (
        pytest.raises(UserError, match="begun with --seed 0, now 3"),
        StudyFolder.opened(tmp_path / "s", identity(seed=3)),
    ):
        pass
    assert (tmp_path / "mine").read_text() == "mine"


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
