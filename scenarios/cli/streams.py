"""Where the answer is printed to, when it cannot take it: a full disk, a pipe that nobody reads, a closed stream."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import sys
from typing import Any

READER_GONE = 141
"""Exit code where nobody reads the pipe any more, as after ``| head -1``: 128 and the number of SIGPIPE."""


def prepare() -> None:
    """Let every stream be there, and able to hold any text."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            # The lowest number that is free: a file opened later would take it, and be printed into.
            os.open(os.devnull, os.O_RDWR)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w", encoding="utf-8"))
        elif isinstance(stream, io.TextIOWrapper):
            # A terminal that knows no such letter, a file's name that is no text.
            stream.reconfigure(errors="backslashreplace")


def settle(stream: Any, *, more: str = "") -> OSError | None:
    """Write out what a stream still holds, and ``more``; where that fails, let it go to nowhere, and return why.

    Left as it is, the interpreter would try again at its end, and end in a traceback.
    """
    try:
        stream.write(more)
        stream.flush()
    except OSError as error:
        with contextlib.suppress(OSError, ValueError):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, stream.fileno())
            os.close(nowhere)
        return error
    except ValueError:
        # Closed by whoever opened it.
        return None
    return None


def reader_is_gone(error: BaseException | None) -> bool:
    """Whether an error says that nobody reads the pipe any more."""
    return isinstance(error, OSError) and error.errno in (errno.EPIPE, errno.ESHUTDOWN)


def unprinted(error: OSError) -> str:
    """What to say where standard output took no more."""
    return f"standard output cannot be written ({error.strerror}); make room, or print elsewhere"
