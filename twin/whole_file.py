"""Files written whole or not at all, also several together.

The content goes to a new file beside the one meant, whose name nobody can foresee; when all of it is on the disk, that
file takes the name. Who reads finds the content before or the content after, whenever the program ends. A link stays
and what it leads to is replaced; permissions stay. Devices, pipes and the program's own streams are written to as they
are.
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
import secrets
import stat
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from twin.errors import UserError

TEMPORARY = ".halltwin-*.part"
"""What matches the names of files that are being written; one that a killed program left may be removed."""
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""What the system says where there is no room for a file."""
_STREAM = re.compile(r"/proc/(self|\d+)/fd/\d+|/dev/(stdin|stdout|stderr|fd/\d+)")
_MOST_LINKS = 40


def write_beside(path: Path, content: bytes) -> None:
    """Write a file whole or not at all. Raises UserError."""
    write_together({path: content})


def write_together(contents: Mapping[Path, bytes]) -> None:
    """Write all files or none: where one fails, the others are as they were. Raises UserError."""
    streams = {path: content for path, content in contents.items() if is_stream(path)}
    begun: list[_Begun] = []
    try:
        for path, content in contents.items():
            check_writable(path)
            if path not in streams:
                with _told(path):
                    begun.append(_begin(path, content))
        for path, content in streams.items():
            with _told(path):
                _write_stream(path, content)
        _finish(begun)
    finally:
        for one in begun:
            for left in (one.beside, one.before):
                if left is not None:
                    with contextlib.suppress(OSError):
                        left.unlink(missing_ok=True)


def write_whole(path: Path, content: bytes) -> None:
    """Write a file whole or not at all, for a program that has its own answer to a full disk. Raises OSError."""
    begun = _begin(path, content)
    try:
        os.replace(begun.beside, begun.target)
    finally:
        begun.beside.unlink(missing_ok=True)


def check_writable(path: Path) -> None:
    """Raise UserError where no file can be written under this name: said before the work, not after it."""
    with _told(path):
        if is_stream(path):
            return
        target = target_of(path)
        if target.is_dir():
            raise UserError(f"{path}: is a folder; give the name of the file to write")
        if target.is_symlink():
            raise UserError(f"{path}: is a link that leads nowhere; give another path")
        if not target.parent.is_dir():
            raise UserError(f"{path}: there is no folder {target.parent}; make it first, or give another path")
        # A file that its owner made read-only is not replaced, although the folder would allow it.
        for needed in (target.parent, target) if target.exists() else (target.parent,):
            if not os.access(needed, os.W_OK):
                raise UserError(f"{path}: no permission to write there; give another path")


def target_of(path: Path) -> Path:
    """The file that a path means, with every link followed."""
    return Path(os.path.realpath(path))


def is_stream(path: Path) -> bool:
    """Whether a path is a device, a pipe or an open file of a process: such is written to, and never replaced."""
    step = Path(os.path.abspath(path))
    for _ in range(_MOST_LINKS):
        if _STREAM.fullmatch(str(step)):
            return True
        if not step.is_symlink():
            break
        step = Path(os.path.abspath(step.parent / step.readlink()))
    return step.exists() and not step.is_file() and not step.is_dir()


@dataclass
class _Begun:
    """A file on its way: where it is meant to go, its content beside it, and a second name of what was there before."""

    path: Path
    target: Path
    beside: Path
    is_new: bool
    before: Path | None = None


def _begin(path: Path, content: bytes) -> _Begun:
    """Write the content to a file beside the one meant, and see to it that it is on the disk. Raises OSError."""
    target = target_of(path)
    beside = new_name(target)
    there = target.stat() if target.exists() else None
    # Without a file there, the permissions are those that the user's umask leaves.
    mode = 0o666 if there is None else stat.S_IMODE(there.st_mode) & 0o777
    number = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0), mode)
    try:
        with open(number, "wb") as out:
            if there is not None:
                _keep(number, there)
            out.write(content)
            out.flush()
            os.fsync(number)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise
    return _Begun(path, target, beside, is_new=there is None)


def new_name(target: Path) -> Path:
    """A name beside a file for what is not finished: nobody can foresee it, and it matches TEMPORARY."""
    return target.with_name(TEMPORARY.replace("*", secrets.token_hex(8)))


def _keep(number: int, there: os.stat_result) -> None:
    """Give an open file the owner and permissions of another, as far as the system lets the user."""
    if hasattr(os, "fchown"):
        with contextlib.suppress(OSError):
            os.fchown(number, there.st_uid, there.st_gid)
    if hasattr(os, "fchmod"):
        os.fchmod(number, stat.S_IMODE(there.st_mode))


def _finish(begun: Sequence[_Begun]) -> None:
    """Let every content take its name; where one cannot, those before get back what they had."""
    try:
        for one in begun:
            with _told(one.path):
                # A single file needs no way back: it is replaced or it is not.
                if len(begun) > 1 and not one.is_new:
                    one.before = _second_name(one.target)
                os.replace(one.beside, one.target)
    except BaseException:
        for one in begun:
            if one.before is not None:
                os.replace(one.before, one.target)
            elif one.is_new and not one.beside.exists():
                one.target.unlink(missing_ok=True)
        raise


def _second_name(target: Path) -> Path:
    """Another name for the content of a file: a hard link, or a copy where the disk knows none."""
    name = new_name(target)
    try:
        os.link(target, name)
    except OSError:
        import shutil

        shutil.copy2(target, name)
    return name


def _write_stream(path: Path, content: bytes) -> None:
    """Write to a device or pipe; to the program's own output by the number it has, after what was printed before."""
    there = path.stat()
    for own, printed in ((1, sys.stdout), (2, sys.stderr)):
        with contextlib.suppress(OSError):
            if os.path.samestat(there, os.fstat(own)):
                printed.flush()
                number = os.dup(own)
                break
    else:
        number = os.open(path, os.O_WRONLY | os.O_APPEND)
    with open(number, "wb") as out:
        out.write(content)


@contextlib.contextmanager
def _told(path: Path) -> Iterator[None]:
    """What the operating system refuses is one line."""
    try:
        yield
    except OSError as error:
        advice = "make room, or give another path" if error.errno in FULL else "give another path"
        raise UserError(f"{path}: cannot be written ({error.strerror or error}); {advice}") from None
