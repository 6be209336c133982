"""Work that the page has asked for, in a process of its own: begun, watched, ended. One at a time."""

from __future__ import annotations

import multiprocessing
import threading
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, Literal

from scenarios.studies.machines import single_threaded

State = Literal["idle", "working", "done", "failed"]
_LEAVES_S = 5.0


class ProcessJob:
    """A process that sends pairs: ``progress`` with words, ``error`` with a line, ``answer`` with plain values.

    A new one ends the one before. Methods of the page's several threads wait for each other.
    """

    def __init__(self, work: Callable[[Connection, Any], None]) -> None:
        self._work = work
        self._lock = threading.Lock()
        self._process: BaseProcess | None = None
        self._line: Connection | None = None
        self._state: State = "idle"
        self._words = ""
        self._began_s = 0.0
        self._answer: dict[str, Any] | None = None

    def begin(self, question: Any) -> None:
        """Begin with a question."""
        with self._lock:
            self._end()
            context = multiprocessing.get_context("spawn")
            self._line, theirs = context.Pipe()
            with single_threaded():
                self._process = context.Process(target=self._work, args=(theirs, question), daemon=True)
                self._process.start()
            theirs.close()
            self._state, self._words, self._answer = "working", "starting", None
            self._began_s = time.monotonic()
            self._begun(question)

    def stand(self) -> dict[str, Any]:
        """Where it stands; with the answer where it is done."""
        with self._lock:
            self._hear()
            told: dict[str, Any] = {"state": self._state, "words": self._words, **self._more()}
            if self._state == "working":
                told["elapsed_s"] = round(time.monotonic() - self._began_s, 1)
            if self._state == "done":
                told["answer"] = self._answer
            return told

    def stop(self) -> None:
        """End it; nothing is kept."""
        with self._lock:
            self._hear()
            if self._state == "working":
                self._end()
                self._state, self._words = "failed", "stopped; nothing is kept"

    def close(self) -> None:
        """End whatever runs."""
        with self._lock:
            self._end()

    def _begun(self, question: Any) -> None:
        """What else is to be kept of a question that work has begun on."""

    def _more(self) -> dict[str, Any]:
        """What else is told of where it stands."""
        return {}

    def _heard(self, kind: str, found: Any) -> None:
        """Take in one message."""
        if kind == "progress":
            self._words = found
        elif kind == "error":
            self._state, self._words = "failed", found
        else:
            self._state, self._words, self._answer = "done", "", found

    def _hear(self) -> None:
        """Take in what the process has sent."""
        try:
            while self._state == "working" and self._line is not None and self._line.poll():
                self._heard(*self._line.recv())
        except (EOFError, OSError):
            self._state, self._words = "failed", "its process has ended without an answer"

    def _end(self) -> None:
        """End the process and forget the line to it."""
        if self._process is not None:
            self._process.terminate()
            self._process.join(_LEAVES_S)
            if self._process.is_alive():
                self._process.kill()
                self._process.join()
            self._process = None
        if self._line is not None:
            self._line.close()
            self._line = None
