"""What a command writes, under one rule: nothing of the user's is lost, and all files are written together or none.

Each output is named before any work is done. It must have an ending of its format and a place where it can be written;
it must be none of the command's inputs and no other output, under whatever name; and a file that is there already must
be one that the program wrote and nobody changed (see ``marks``), unless the user said ``--force``.
"""

from __future__ import annotations

import contextlib
import gzip
import json
import os
import stat
import unicodedata
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from scenarios.commands.inputs import ENDINGS
from scenarios.commands.marks import is_own, mark_written, marked
from twin.ending import ending_of
from twin.errors import UserError
from twin.regular_file import digest
from twin.whole_file import check_writable, is_stream, target_of, write_together


@dataclass(frozen=True)
class Format:
    """What may be written under a name: its endings, and whether files of it are marked as the program's own."""

    words: str
    endings: tuple[str, ...]
    marked: bool = True


SWEEP = Format("sweeps", (".csv", ".csv.gz"))
MEASURED = Format("sweeps", SWEEP.endings, marked=False)
"""What a bench measured: nobody can compute it again, so that it is never replaced unasked."""
TABLE = Format("tables", (".csv", ".csv.gz"))
JSON = Format("answers", (".json",))
TOML = Format("such files", (".toml",))
HTML = Format("reports", (".html", ".htm"))
PAGES = Format("files of the guide", (".html", ".css", ".png"))
HEADER = Format("C headers", (".h", ".hh", ".hpp"))
PICTURE = Format("pictures", (".png", ".svg", ".pdf"))
CONFIGURATION = Format("such tables", (".cfg",))
PARQUET = Format("such tables", (".parquet",))
PYTHON = Format("effects", (".py",), marked=False)
"""A file to write one's own physics into."""

_FILES = {
    end
    for form in (TABLE, JSON, TOML, HTML, PAGES, HEADER, PICTURE, CONFIGURATION, PARQUET, PYTHON)
    for end in form.endings
}

Given = tuple[Path | None, Format]


def drive_table(ending: str) -> Format:
    """The format of a drive's table whose files end so."""
    return next(form for form in (HEADER, TABLE, CONFIGURATION) if ending in form.endings)


@dataclass(frozen=True)
class OutputFiles:
    """The files that a command will write; see the module's text.

    ``inputs`` are the files that it reads, ``force`` lets it replace files of others, ``folders`` lets it make the
    folders that are not there yet. ``unfinished`` are files that an earlier run of the same work wrote, each with the
    SHA-256 of what that run wrote there.
    """

    formats: Mapping[Path, Format]
    inputs: tuple[Path, ...] = ()
    force: bool = False
    folders: bool = False
    unfinished: Mapping[Path, Collection[str]] = field(default_factory=dict)

    @classmethod
    def checked(
        cls,
        given: Iterable[Given],
        *,
        inputs: Iterable[str | Path | None] = (),
        force: bool = False,
        folders: bool = False,
        unfinished: Mapping[Path, Collection[str]] | None = None,
    ) -> OutputFiles:
        """The outputs that are not None, all of them fit to be written. Raises UserError before anything is done."""
        asked = [(path, form) for path, form in given if path is not None]
        read = tuple(file for name in inputs if name is not None for file in _files(Path(name)))
        outputs = cls(formats=dict(asked), inputs=read, force=force, folders=folders, unfinished=unfinished or {})
        _check_distinct([path for path, _ in asked])
        outputs.check()
        return outputs

    def check(self, paths: Iterable[Path] | None = None) -> None:
        """Refuse what cannot be written here, an input, and a file of somebody else's. Raises UserError.

        ``paths``: some of the outputs; None: all.
        """
        asked = list(self.formats if paths is None else paths)
        self._check_inputs()
        if self.folders:
            for folder in {path.parent: None for path in asked}:
                check_folder(folder)
        for path in asked:
            if not self.folders or path.parent.exists():
                check_writable(path)
        for path in asked:
            check_ending(path, self.formats[path])
            if not (self.force or _adds_to_printed(path)):
                _check_own(path, self.formats[path], self.unfinished.get(path, ()))

    def _check_inputs(self) -> None:
        """Refuse an output that is an input, or the file that the printed answer goes to. Raises UserError.

        The printed answer is an output, too.
        """
        read = {identity: path for path in self.inputs if (identity := _identity(path))}
        printed = _identity(1)
        if printed is not None and printed in read:
            raise UserError(f"{read[printed]}: is read, and standard output goes to it; print to another file")
        for path in self.formats:
            identity = _identity(path)
            if identity in read or (identity is not None and identity == printed and not is_stream(path)):
                raise _used_already(path)

    def write(
        self, contents: Mapping[Path | None, Any], *, before: Callable[[Mapping[Path, bytes]], None] | None = None
    ) -> None:
        """Make the contents of the outputs, then write all of them or none. Raises UserError.

        A content is text, bytes or a figure of matplotlib's, or a function that makes one of them. The key None is
        passed over, so that a command lists everything it may be asked for. ``before`` is called with what each file
        will hold, when nothing is written yet.
        """
        made = {path: self._packed(path, content) for path, content in contents.items() if path is not None}
        # Much may have happened since the work began.
        self.check(made)
        if before is not None:
            before(made)
        with _folders_for(made) if self.folders else contextlib.nullcontext():
            write_together(made)
        for path, content in made.items():
            if self.formats[path].marked and not is_stream(path):
                mark_written(path, content)

    def tell_written(self, notes: Mapping[Path, str] | None = None) -> None:
        """Print in one line which files were written, with a note in brackets where there is one.

        What went to a device or a pipe is not told: whoever reads there would take the line for more of it.
        """
        notes = notes or {}
        paths = [path for path in self.formats if not is_stream(path)]
        names = [path.name if self.folders else str(path) for path in paths]
        told = [f"{name} ({notes[path]})" if path in notes else name for path, name in zip(paths, names, strict=True)]
        if told:
            print(f"wrote {', '.join(told)}{f' to {paths[0].parent}' if self.folders else ''}")

    def _packed(self, path: Path, content: Any) -> bytes:
        """The bytes of a file, with its mark, compressed where the name says so."""
        form = self.formats[path]
        raw = _bytes_of(content() if callable(content) else content, path)
        if form.marked and not is_stream(path):
            raw = marked(path, raw)
        return gzip.compress(raw, mtime=0) if ending_of(path).endswith(".gz") else raw


def _bytes_of(content: Any, path: Path) -> bytes:
    """Text as UTF-8, a figure in the format that the path's ending says."""
    if isinstance(content, bytes):
        return content
    if isinstance(content, str):
        # Names of files may hold bytes that are no text.
        return content.encode(errors="backslashreplace")
    from diagnosis.report.plotting import figure_bytes

    return figure_bytes(content, ending_of(path))


def check_ending(path: Path, form: Format) -> None:
    """Refuse a name that does not end as its format asks. Raises UserError."""
    if form is PICTURE:
        from diagnosis.report.plotting import check_format

        check_format(path)
    elif ending_of(path) not in form.endings and not is_stream(path):
        raise UserError(f"{path}: {form.words} end in {' or '.join(form.endings)}; give a name that does")


def _check_distinct(paths: Iterable[Path]) -> None:
    """Refuse two names of one file, also where the disk does not tell large letters from small."""
    seen: set[object] = set()
    for path in paths:
        identity = _identity(path)
        if is_stream(path) and identity is None:
            continue
        name = unicodedata.normalize("NFC", str(target_of(path))).casefold()
        names = {name, identity or name}
        if names & seen:
            raise _used_already(path)
        seen |= names


def _used_already(path: Path) -> UserError:
    return UserError(f"{path}: is read or written already by this command; give each output a name of its own")


def _check_own(path: Path, form: Format, written: Collection[str]) -> None:
    """Refuse to replace a file that holds anything and is not as the program wrote it, by its mark or by a digest."""
    try:
        if _identity(path) is None or path.stat().st_size == 0 or (form.marked and is_own(path)):
            return
        if written and path.is_file() and digest(target_of(path)) in written:
            return
    except OSError as error:
        raise UserError(f"{path}: is there already and cannot be read ({error.strerror}); give another name") from None
    whose = " and was not written by halltwin, or was changed since" if form.marked else ""
    raise UserError(f"{path}: is there already{whose}; give another name, or --force to replace it")


def _files(path: Path) -> list[Path]:
    """The files that an input stands for: a folder stands for the sweeps in it."""
    return [item for item in path.iterdir() if ending_of(item) in ENDINGS] if path.is_dir() else [path]


def _adds_to_printed(path: Path) -> bool:
    """Whether a path is a name of the program's own output, which may go to a file that holds something already."""
    return is_stream(path) and _identity(path) in (_identity(1), _identity(2))


def _identity(file: Path | int) -> tuple[int, int] | None:
    """What is the same for all names of a file, an open one by its number too; None for a device, a pipe or nothing."""
    try:
        found = os.stat(file)
    except OSError:
        return None
    return (found.st_dev, found.st_ino) if stat.S_ISREG(found.st_mode) else None


def check_folder(folder: Path) -> None:
    """Refuse what is a file, is named like one, or cannot be made, where a folder is to be. Raises UserError."""
    there = next(parent for parent in (folder, *folder.parents) if parent.exists())
    if not there.is_dir():
        below = "" if there == folder else f"{there} "
        raise UserError(f"{folder}: {below}is a file; several files are written: give the name of a folder")
    if there == folder:
        return
    if ending_of(folder) in _FILES:
        raise UserError(f"{folder}: is named like a file; several files are written: give the name of a folder")
    if not os.access(there, os.W_OK):
        raise UserError(f"{folder}: no permission to make it; give another path")


def json_text(content: Mapping[str, Any]) -> str:
    """Plain values as the text of a JSON file. Raises ValueError for a figure that is not finite."""
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


@contextlib.contextmanager
def _folders_for(paths: Iterable[Path]) -> Iterator[None]:
    """Make the folders of these files; take them away again where the files cannot be written."""
    made: list[Path] = []
    try:
        for parent in {path.parent: None for path in paths}:
            missing = [folder for folder in (parent, *parent.parents) if not folder.exists()]
            for folder in reversed(missing):
                try:
                    folder.mkdir(exist_ok=True)
                except OSError as error:
                    raise UserError(f"{folder}: cannot be made ({error.strerror}); give another path") from None
                made.append(folder)
        yield
    except BaseException:
        for folder in reversed(made):
            with contextlib.suppress(OSError):
                folder.rmdir()
        raise
