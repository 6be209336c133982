"""The folder of a study: what it is of, which parts are complete, and small results as one .npz a chunk.

``study.json`` names the study, the version of the program, the seed and all settings; a run with others is refused as
long as anything is complete. ``done/000012`` marks chunk 12 as complete and holds the SHA-256 of its files, as
``sha256sum`` writes them: a chunk that was damaged since is computed anew. ``chunks/000012.npz`` holds its arrays
where a study keeps them so. ``study.lock`` is there while a command works in the folder.

Nothing is removed or replaced that the study did not write: that is what a mark lists, what is equal to what would take
its place, and temporary files of the program's own.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import os
import re
import shutil
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.commands.file_lock import alone
from scenarios.commands.interrupt import interruptible
from scenarios.commands.outputs import check_folder
from scenarios.studies.chunk_files import joined
from scenarios.studies.identity import Identity, read_record
from twin.bounded_input import LARGEST_TEXT_BYTES
from twin.errors import UserError
from twin.regular_file import content, digest
from twin.whole_file import TEMPORARY, new_name, write_whole

_IDENTITY, _LOCK, _DONE, _CHUNKS = "study.json", "study.lock", "done", "chunks"
_OWN_UNFINISHED = re.compile(re.escape(TEMPORARY).replace(r"\*", "[0-9a-f]{16}"))
_EMPTY = hashlib.sha256().hexdigest()
"""An empty file holds nothing of anybody's: a loss of power leaves such."""


@dataclass(frozen=True)
class StudyFolder:
    """See the module's text. ``path`` is absolute, so that workers elsewhere on a shared file system find it."""

    path: Path

    @classmethod
    @contextlib.contextmanager
    def opened(cls, path: Path, identity: Identity, *, stores: Sequence[str] = ()) -> Iterator[StudyFolder]:
        """Begin a study in this folder, or go on with it, and keep every other command out meanwhile.

        ``stores`` are folders in it that the study fills beside its chunks. Raises UserError where the folder holds
        something else or another command is at work there. Ctrl-C within ends the program with a line that says how
        to go on.
        """
        check_folder(path)
        folder = cls(path.absolute())
        folder._refuse_foreign()
        made = folder._make()
        busy = f"{path}: another halltwin is at work in this folder; wait until it ends"
        try:
            with interruptible(lambda: folder._kept(path)), alone(folder.path / _LOCK, busy=busy):
                folder._begin(identity, stores)
                try:
                    yield folder
                finally:
                    folder._clear_unfinished()
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
        if not self.path.is_dir() or (self.path / _IDENTITY).exists():
            return
        for item in self.path.iterdir():
            begun = item.name == _DONE and item.is_dir() and not any(item.iterdir())
            if not (begun or item.name == _LOCK or _OWN_UNFINISHED.fullmatch(item.name)):
                raise UserError(f"{self.path}: exists and is no study; give the name of a new folder")

    def _begin(self, identity: Identity, stores: Sequence[str]) -> None:
        """Write the record, or hold the one that is there against it."""
        # Another command may have been there between the first look and the lock.
        self._refuse_foreign()
        self._clear_unfinished()
        record = self.path / _IDENTITY
        if record.exists():
            other = identity.difference(read_record(record))
            if not other:
                return
            # While nothing is complete nothing is lost, and a mistake in the settings does not block their correction.
            if self._complete() or not self._taken_back(stores):
                raise UserError(
                    f"{self.path}: was begun with {other}; give another folder, or the same settings to go on"
                )
        try:
            write_whole(record, identity.text().encode())
        except OSError as error:
            raise UserError(
                f"{record}: cannot be written ({error.strerror}); make room and run the same command again"
            ) from None

    def _taken_back(self, stores: Sequence[str]) -> bool:
        """Remove what the marks list, and the marks, where there is nothing else; whether that was so."""
        own: set[Path] = set()
        for mark in (self.path / _DONE).glob("*"):
            if self.damaged(mark.name) == []:
                own |= {mark, *self._listed(mark.name)}
        places = [self.path / name for name in (_DONE, _CHUNKS, *stores)]
        there = {item for place in places for item in place.rglob("*") if item.is_symlink() or not item.is_dir()}
        if there - own:
            return False
        for file in there:
            file.unlink()
            for folder in file.relative_to(self.path).parents[:-1]:
                with contextlib.suppress(OSError):
                    (self.path / folder).rmdir()
        return True

    def _complete(self) -> int:
        """How many chunks are marked as complete."""
        return sum(mark.name.isdigit() for mark in (self.path / _DONE).glob("*"))

    def _kept(self, path: Path) -> str:
        return f"{self._complete()} complete chunks are kept in {path}: run the same command again to go on"

    def _clear_unfinished(self) -> None:
        """Take away what killed runs left half-written: our own names alone."""
        for place in (self.path, self.path / _DONE, self.path / _CHUNKS):
            for left in place.glob(TEMPORARY):
                if _OWN_UNFINISHED.fullmatch(left.name):
                    _remove(left)

    # ---- parts ----------------------------------------------------------------------------------------------------

    def is_done(self, chunk: int) -> bool:
        """Whether the chunk is complete, and every file of it as it was written."""
        return self.damaged(part_of(chunk)) == []

    def mark(self, part: str, files: Iterable[Path]) -> None:
        """Say that a part, which is these files, is complete. Raises UserError and OSError."""
        lines = [f"{digest(file)}  {file.relative_to(self.path).as_posix()}\n" for file in sorted(files)]
        target = self.path / _DONE / part
        target.parent.mkdir(exist_ok=True)
        if os.path.lexists(target):
            # Only a plain file is a mark that was damaged.
            digest(target)
        write_whole(target, "".join(lines).encode())

    def damaged(self, part: str) -> list[Path] | None:
        """The files of a part that are not as they were when it was complete; None where it never was."""
        listed = self._listed(part)
        return [file for file, wanted in listed.items() if _digest_or_none(file) != wanted] if listed else None

    def _listed(self, part: str) -> dict[Path, str]:
        """The files of a part, each with its digest, as its mark lists them; none where the mark is none."""
        try:
            text = content(self.path / _DONE / part, most=LARGEST_TEXT_BYTES, expected="a list of digests").decode()
            pairs = [line.split("  ", 1) for line in text.splitlines()]
            listed = {self.path / name: wanted for wanted, name in pairs}
        except (OSError, ValueError, UserError):
            return {}
        inside = all(".." not in file.parts and file.is_relative_to(self.path) for file in listed)
        return listed if inside else {}

    @contextlib.contextmanager
    def workspace(self) -> Iterator[Path]:
        """A folder for what is not finished; it is gone afterwards, at the latest with the next run. Raises OSError."""
        path = new_name(self.path / "study")
        path.mkdir()
        try:
            yield path
        finally:
            shutil.rmtree(path, ignore_errors=True)

    def copied(self, part: str, beside: Path) -> list[Path]:
        """Copy the files of a part into a workspace; where the copies are. Raises UserError and OSError."""
        copies = []
        for file, wanted in self._listed(part).items():
            copy = beside / file.relative_to(self.path)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, copy, follow_symlinks=False)
            if digest(copy) != wanted:
                raise UserError(f"{file}: is not as this study wrote it; delete it and run the same command again")
            copies.append(copy)
        return copies

    def place(self, part: str, beside: Path) -> list[Path]:
        """Give every file of a workspace, which are those of a part, its place in the folder; where they are now.

        Raises UserError where something is there that the study did not write, and OSError.
        """
        files = [file for file in sorted(beside.rglob("*")) if file.is_file()]
        places = [self.path / file.relative_to(beside) for file in files]
        listed = self._listed(part)
        for file, place in zip(files, places, strict=True):
            if os.path.lexists(place) and digest(place) not in (digest(file), _EMPTY) and place not in listed:
                raise UserError(f"{place}: was not written by this study; move it away and run the same command again")
        for file, place in zip(files, places, strict=True):
            place.parent.mkdir(parents=True, exist_ok=True)
            os.replace(file, place)
        return places

    # ---- chunks ---------------------------------------------------------------------------------------------------

    def save(self, chunk: int, arrays: Mapping[str, np.ndarray[Any, Any]]) -> list[Path]:
        """Write a chunk's arrays as .npz, whole or not at all; the files that it is made of.

        Raises UserError where somebody's file is in its place, and OSError.
        """
        out = io.BytesIO()
        # Its own argument, allow_pickle, is newer than the oldest numpy, which would store it as an array.
        np.savez(out, **arrays)  # type: ignore[arg-type]
        with self.workspace() as beside:
            (beside / _CHUNKS).mkdir()
            write_whole(beside / _CHUNKS / f"{part_of(chunk)}.npz", out.getvalue())
            return self.place(part_of(chunk), beside)

    def load(self, chunks: int | Iterable[int], required: Collection[str] = ()) -> dict[str, np.ndarray[Any, Any]]:
        """The arrays of these chunks, or of so many, one after the other along their first axis, with these names.

        Raises UserError.
        """
        numbers = range(chunks) if isinstance(chunks, int) else chunks
        files = [self.path / _CHUNKS / f"{part_of(chunk)}.npz" for chunk in numbers]
        return joined(files, required)


def part_of(chunk: int) -> str:
    """The name of a chunk among the parts of a study."""
    return f"{chunk:06d}"


def _digest_or_none(file: Path) -> str | None:
    """The SHA-256 of a plain file; None where there is none. Raises UserError where there is something else."""
    try:
        return digest(file)
    except OSError:
        return None


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)
