"""The search that the page has asked for: begun, watched, stopped, and looked at, in a process of its own."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
import time
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Literal

from scenarios.lab.explain_worker import Question, work
from scenarios.studies.machines import single_threaded
from twin.errors import UserError

State = Literal["idle", "working", "done", "failed"]
BUDGET_S, SEED = 120.0, 0
"""As ``halltwin explain`` has them unless told otherwise."""
_LOOK_S = 60.0
_LEAVES_S = 5.0


class Explaining:
    """One search at a time; a new one ends the one before."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: BaseProcess | None = None
        self._line: Connection | None = None
        self._state: State = "idle"
        self._words = ""
        self._began_s = 0.0
        self._answer: dict[str, Any] | None = None
        self._question: Question | None = None
        self._stops = 0

    def begin(self, question: Question) -> None:
        """Begin a search."""
        with self._lock:
            self._end()
            context = multiprocessing.get_context("spawn")
            self._line, theirs = context.Pipe()
            with single_threaded():
                self._process = context.Process(target=work, args=(theirs, question), daemon=True)
                self._process.start()
            theirs.close()
            self._state, self._words, self._stops = "working", "starting", 0
            self._question, self._answer, self._began_s = question, None, time.monotonic()

    def stand(self) -> dict[str, Any]:
        """Where the search stands; with the answer where it is done."""
        with self._lock:
            self._hear()
            told: dict[str, Any] = {"state": self._state, "words": self._words}
            if self._state == "working":
                told["elapsed_s"] = round(time.monotonic() - self._began_s, 1)
            if self._state == "done":
                told["answer"] = self._answer
            return told

    def stop(self) -> None:
        """End the search where it stands, as Ctrl-C does: once for the answer so far, twice for none."""
        with self._lock:
            self._hear()
            if self._state != "working" or self._process is None:
                return
            self._stops += 1
            if self._stops > 1 or not hasattr(os, "setsid"):
                self._end()
                self._state, self._words = "failed", "stopped; nothing is kept"
            elif self._process.pid is not None:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(self._process.pid, signal.SIGINT)
                self._words = "stopping: the answer so far follows; stop again to have none"

    def look(self, content: Any) -> dict[str, Any]:
        """The residual as it is asked for. Raises UserError."""
        with self._lock:
            self._hear()
            if self._state != "done" or self._line is None:
                raise UserError("no sweep has been explained; open one first")
            try:
                self._line.send(content)
                if not self._line.poll(_LOOK_S):
                    raise EOFError
                kind, found = self._line.recv()
            except (EOFError, OSError):
                self._end()
                self._state, self._words = "failed", "the search's process has ended; explain the sweep again"
                raise UserError(self._words) from None
            if kind == "error":
                raise UserError(found)
            told: dict[str, Any] = found
            return told

    def file(self, name: str) -> tuple[bytes, str]:
        """A file of the answer, and what the browser saves it as. Raises UserError where there is none."""
        with self._lock:
            self._hear()
            if self._state != "done" or self._question is None:
                raise UserError("no sweep has been explained; open one first")
            return (self._question.folder / name).read_bytes(), name

    def close(self) -> None:
        """End whatever runs."""
        with self._lock:
            self._end()

    def _hear(self) -> None:
        """Take in what the process has sent."""
        try:
            while self._state == "working" and self._line is not None and self._line.poll():
                kind, found = self._line.recv()
                if kind == "progress":
                    self._words = found
                elif kind == "error":
                    self._state, self._words = "failed", found
                else:
                    self._state, self._words, self._answer = "done", "", found
        except (EOFError, OSError):
            self._state, self._words = "failed", "the search's process has ended without an answer"

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


def question_of(sweep: Path, name: str, *, shown: str, twin: tuple[str, str] | None, folder: Path) -> Question:
    """The question about a sweep, with the command line that asks the same.

    ``shown`` is the sweep as the command line would name it; ``twin`` where the twin that it is held against is read
    from, and how the command line would name that.
    """
    import shlex

    words = ["halltwin", "explain", f"./{shown}" if shown.startswith("-") else shown]
    words += [] if twin is None else ["--twin", twin[1]]
    return Question(
        sweep=sweep,
        name=name,
        twin=None if twin is None else twin[0],
        command=shlex.join([*words, "--seed", str(SEED)]),
        budget_s=BUDGET_S,
        seed=SEED,
        folder=folder,
    )
