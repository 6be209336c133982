"""Files that the program keeps for itself, such as journals and chunks: plain files, and nothing behind a link.

Under such a name may lie a link to somebody's file, a pipe on which a reader waits forever, or a device without an end.
"""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from pathlib import Path

from twin.errors import UserError


def opened(path: Path, flags: int = os.O_RDONLY) -> int:
    """The descriptor of a plain file, opened with these flags of :mod:`os`.

    Raises
    ------
    UserError
        There is a link, a folder, a pipe or a device.
    OSError
        It cannot be opened, e.g. FileNotFoundError.
    """
    # A pipe must not keep its reader waiting before it can be told.
    careful = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        number = os.open(path, flags | careful, 0o666)
    except OSError as error:
        if error.errno in (errno.ELOOP, errno.EISDIR, errno.ENXIO):
            raise _no_plain_file(path) from None
        raise
    if stat.S_ISREG(os.fstat(number).st_mode):
        return number
    os.close(number)
    raise _no_plain_file(path)


def content(path: Path, *, most: int, expected: str) -> bytes:
    """The bytes of a plain file that holds at most so many. Raises UserError, as above, and OSError."""
    with open(opened(path), "rb") as file:
        if os.fstat(file.fileno()).st_size > most:
            raise UserError(f"{path}: holds more than {most / 1e6:g} MB; expected {expected}; move it away")
        return file.read(most)


def digest(path: Path) -> str:
    """The SHA-256 of a plain file. Raises UserError and OSError."""
    with open(opened(path), "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _no_plain_file(path: Path) -> UserError:
    return UserError(f"{path}: is a link, a folder, a pipe or a device; expected a plain file: move it away")
