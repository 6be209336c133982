"""One process at a time: a lock on a file, which the system takes away with the process that holds it."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from twin.errors import UserError
from twin.regular_file import opened


@contextlib.contextmanager
def alone(path: Path, *, busy: str) -> Iterator[None]:
    """Hold the lock file ``path``, which is made and taken away again; refused where another process holds it.

    A killed process holds nothing, and neither do the workers that it started: a file that it left is taken over.

    Parameters
    ----------
    path
        The lock file. It stays empty.
    busy
        What the UserError says where another process is at work.

    Raises
    ------
    UserError
        Another process holds the lock, or the file is no lock.
    OSError
        The file cannot be made.
    """
    held = _held(path)
    if held is None:
        raise UserError(busy)
    try:
        yield
    finally:
        # While it is still held, so that nobody takes up a file that goes. Windows keeps a file that is open.
        with contextlib.suppress(OSError):
            path.unlink()
        os.close(held)


def _held(path: Path) -> int | None:
    """The locked file's descriptor, which no child inherits; None where another process holds it."""
    while True:
        descriptor = opened(path, os.O_RDWR | os.O_CREAT)
        try:
            locked = _locked(descriptor, path)
            if os.fstat(descriptor).st_size:
                raise UserError(f"{path}: holds something and is no lock; move it away")
            # Its holder may have taken the file away in between: then the lock is on a file that nobody else sees.
            current = locked and path.exists() and os.path.samestat(os.fstat(descriptor), path.stat())
        except BaseException:
            os.close(descriptor)
            raise
        if current:
            return descriptor
        os.close(descriptor)
        if not locked:
            return None


def _locked(descriptor: int, path: Path) -> bool:
    """Whether the lock was free. Where the file system knows no locks that is said, and taken for free."""
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    except OSError as error:
        print(
            f"halltwin: {path.parent}: its file system has no locks ({error.strerror}): start no second command there",
            file=sys.stderr,
        )
    return True
