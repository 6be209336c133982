"""The folder of a study: what it is of, which parts are complete, and small results as one .npz a chunk.

``study.json`` names the study, the version of the program, the seed and all settings; a run with others is refused as
long as anything is complete. ``done/000012`` marks chunk 12 as complete and holds the SHA-256 of its files, as
``sha256sum`` writes them: a chunk that was damaged since is computed anew. ``chunks/000012.npz`` holds its arrays
where a study keeps them so. ``study.lock`` is there while a command works in the folder.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import re
import shutil
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.report.provenance import version
from scenarios.commands.file_lock import alone
from scenarios.commands.interrupt import interruptible
from scenarios.studies.identity import flat, read_record, refuse_other
from twin.errors import UserError
from twin.whole_file import TEMPORARY, new_name, write_whole

_IDENTITY, _LOCK, _DONE, _CHUNKS = "study.json", "study.lock", "done", "chunks"
_OWN_UNFINISHED = re.compile(re.escape(TEMPORARY).replace(r"\*", "[0-9a-f]{16}"))
_ZARR_UNFINISHED = re.compile(r".+\.[0-9a-f]{32}\.partial")


@dataclass(frozen=True)
class StudyFolder:
    """See the module's text. ``path`` is absolute, so that workers elsewhere on a shared file system find it."""

    path: Path

    @classmethod
    @contextlib.contextmanager
    def opened(
        cls, path: Path, *, study: str, seed: int, settings: Mapping[str, Any], stores: Sequence[str] = ()
    ) -> Iterator[StudyFolder]:
        """Begin a study in this folder, or go on with it, and keep every other command out meanwhile.

        ``stores`` are folders in it that the study fills beside its chunks. Raises UserError where the folder holds
        something else or another command is at work there. Ctrl-C within ends the program with a line that says how
        to go on.
        """
        folder = cls(path.absolute())
        identity = {"study": study, "version": version(), "seed": seed, "settings": settings}
        folder._refuse_foreign()
        made = folder._make()
        busy = f"{path}: another halltwin is at work in this folder; wait until it ends"
        try:
            with interruptible(lambda: folder._kept(path)), alone(folder.path / _LOCK, busy=busy):
                folder._begin(identity, stores)
                try:
                    yield folder
                finally:
                    folder._clear_unfinished(stores)
        finally:
            if made and not (folder.path / _IDENTITY).exists():
                with contextlib.suppress(OSError):
                    folder.path.rmdir()

    def _make(self) -> bool:
        """Make the folder; whether it was not there."""
        if self.path.is_dir():
            return False
        try:
            self.path.mkdir(parents=True)
        except FileExistsError:
            return False
        except OSError as error:
            raise UserError(f"{self.path}: cannot be made ({error.strerror}); give another path") from None
        return True

    def _refuse_foreign(self) -> None:
        """Raise UserError where the folder holds anything but a study or the beginning of one."""
        if self.path.exists() and not self.path.is_dir():
            raise UserError(f"{self.path}: exists and is no folder; give the name of a new folder")
        if not self.path.is_dir() or (self.path / _IDENTITY).exists():
            return
        for item in self.path.iterdir():
            begun = item.name == _DONE and item.is_dir() and not any(item.iterdir())
            if not (begun or item.name == _LOCK or _OWN_UNFINISHED.fullmatch(item.name)):
                raise UserError(f"{self.path}: exists and is no study; give the name of a new folder")

    def _begin(self, identity: Mapping[str, Any], stores: Sequence[str]) -> None:
        """Write the record, or hold the one that is there against it."""
        # Another command may have been there between the first look and the lock.
        self._refuse_foreign()
        self._clear_unfinished(stores)
        record = self.path / _IDENTITY
        text = json.dumps(identity, indent=1, sort_keys=True, allow_nan=False) + "\n"
        if record.exists():
            found, asked = read_record(record), flat(json.loads(text))
            if found == asked or self._complete():
                refuse_other(self.path, found, asked)
                return
            # Nothing is complete, so nothing is lost, and a mistake in the settings does not block their correction.
            for name in (_DONE, _CHUNKS, *stores):
                shutil.rmtree(self.path / name, ignore_errors=True)
        try:
            write_whole(record, text.encode())
        except OSError as error:
            raise UserError(
                f"{record}: cannot be written ({error.strerror}); make room and run the same command again"
            ) from None

    def _complete(self) -> int:
        """How many chunks are marked as complete."""
        return sum(mark.name.isdigit() for mark in (self.path / _DONE).glob("*"))

    def _kept(self, path: Path) -> str:
        return f"{self._complete()} complete chunks are kept in {path}: run the same command again to go on"

    def _clear_unfinished(self, stores: Sequence[str]) -> None:
        """Take away what killed runs left half-written: our own names alone, and zarr's in its stores."""
        for place in (self.path, self.path / _DONE, self.path / _CHUNKS):
            for left in place.glob(TEMPORARY):
                if _OWN_UNFINISHED.fullmatch(left.name):
                    _remove(left)
        for store in stores:
            for left in (self.path / store).rglob("*.partial"):
                if _ZARR_UNFINISHED.fullmatch(left.name):
                    _remove(left)

    # ---- parts ----------------------------------------------------------------------------------------------------

    def is_done(self, chunk: int) -> bool:
        """Whether the chunk is complete, and every file of it as it was written."""
        return self.damaged(f"{chunk:06d}") == []

    def mark(self, part: str, files: Iterable[Path]) -> None:
        """Say that a part, which is these files, is complete. Raises OSError."""
        lines = [f"{_digest(file)}  {file.relative_to(self.path).as_posix()}\n" for file in sorted(files)]
        target = self.path / _DONE / part
        target.parent.mkdir(exist_ok=True)
        write_whole(target, "".join(lines).encode())

    def damaged(self, part: str) -> list[Path] | None:
        """The files of a part that are not as they were when it was complete; None where it never was."""
        try:
            lines = (self.path / _DONE / part).read_text(encoding="utf-8").splitlines()
            wanted = [(self.path / name, digest) for digest, name in (line.split("  ", 1) for line in lines)]
            return [file for file, digest in wanted if _digest(file) != digest] if wanted else None
        except (OSError, ValueError):
            return None

    @contextlib.contextmanager
    def workspace(self) -> Iterator[Path]:
        """A folder for what is not finished; it is gone afterwards, at the latest with the next run. Raises OSError."""
        path = new_name(self.path / "study")
        path.mkdir()
        try:
            yield path
        finally:
            shutil.rmtree(path, ignore_errors=True)

    # ---- chunks ---------------------------------------------------------------------------------------------------

    def save(self, chunk: int, arrays: Mapping[str, np.ndarray[Any, Any]]) -> list[Path]:
        """Write a chunk's arrays as .npz, whole or not at all; the files that it is made of. Raises OSError."""
        out = io.BytesIO()
        # Its own argument, allow_pickle, is newer than the oldest numpy, which would store it as an array.
        np.savez(out, **arrays)  # type: ignore[arg-type]
        target = self._chunk(chunk)
        target.parent.mkdir(exist_ok=True)
        write_whole(target, out.getvalue())
        return [target]

    def load(self, chunks: int) -> dict[str, np.ndarray[Any, Any]]:
        """The arrays of all chunks, one after the other along their first axis. Raises UserError."""
        parts = [self._arrays(chunk) for chunk in range(chunks)]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def _arrays(self, chunk: int) -> dict[str, np.ndarray[Any, Any]]:
        try:
            with np.load(self._chunk(chunk), allow_pickle=False) as content:
                return {name: content[name] for name in content.files}
        except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
            raise UserError(
                f"{self._chunk(chunk)}: cannot be read ({type(error).__name__}); run the same command again to compute "
                "it anew"
            ) from None

    def _chunk(self, chunk: int) -> Path:
        return self.path / _CHUNKS / f"{chunk:06d}.npz"


def _digest(file: Path) -> str:
    with file.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)
