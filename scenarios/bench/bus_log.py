"""A log of the bus in one of python-can's formats: every frame that was sent or received."""

from __future__ import annotations

import contextlib
import sqlite3
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import can

from twin.ending import ending_of
from twin.errors import UserError

LOG_FORMATS = (".asc", ".blf", ".csv", ".db", ".log", ".trc")
"""Formats of python-can that hold every frame whole, without further packages."""


class BusLog:
    """Open for writing; whoever opens it closes it."""

    def __init__(self, path: Path, *, replace: bool = False) -> None:
        """Begin a log. Raises UserError for a format that cannot hold the frames, and where there is such a file."""
        check_log_name(path)
        if replace:
            # Some formats would go on in a file that is there.
            path.unlink(missing_ok=True)
        if path.exists():
            raise UserError(f"{path}: there is such a file; a log is not written over: give another name")
        self._path = path
        self._failure: BaseException | None = None
        # A database is written by a thread of python-can's, which would end with a traceback and nobody the wiser.
        self._elsewhere = threading.excepthook
        threading.excepthook = self._hear
        try:
            with self._told():
                self._log: Any = can.Logger(str(path))
        except BaseException:
            threading.excepthook = self._elsewhere
            raise

    def write(self, message: can.Message) -> None:
        """Write a frame. Raises UserError."""
        with self._told():
            self._log.on_message_received(message)

    def close(self) -> None:
        """Write what is left. Raises UserError, unless the user was told already."""
        threading.excepthook = self._elsewhere
        told = self._failure is not None
        try:
            with self._told():
                self._log.stop()
        except UserError:
            if not told:
                raise

    def _hear(self, failed: threading.ExceptHookArgs) -> None:
        if isinstance(failed.exc_value, sqlite3.Error):
            self._failure = failed.exc_value
        else:
            self._elsewhere(failed)

    @contextlib.contextmanager
    def _told(self) -> Iterator[None]:
        """What goes wrong with the file is one line."""
        try:
            yield
        except OSError as error:
            self._failure = error
        if self._failure is not None:
            said = getattr(self._failure, "strerror", None) or self._failure
            raise UserError(f"{self._path}: cannot be written ({said}); make room, or give another path") from None


def check_log_name(path: Path) -> None:
    """Raise UserError where python-can cannot tell the format by the name."""
    if (ending := ending_of(path)) not in LOG_FORMATS:
        raise UserError(f"{path.name}: bus logs end in {', '.join(LOG_FORMATS)}; found '{ending}'")
