"""The search that the page has asked for: watched, stopped as Ctrl-C does, and looked at."""

from __future__ import annotations

import contextlib
import os
import signal
from pathlib import Path
from typing import Any

from scenarios.lab.explain_worker import SO_FAR, Question, work
from scenarios.lab.process_job import ProcessJob
from twin.errors import UserError

BUDGET_S, SEED = 120.0, 0
"""As ``halltwin explain`` has them unless told otherwise."""
_LOOK_S = 60.0


class Explaining(ProcessJob):
    """One search at a time; its process stays, and answers to looks."""

    def __init__(self) -> None:
        super().__init__(work)
        self._question: Question | None = None
        self._stops = 0
        self._computed_s = 0.0

    def _begun(self, question: Question) -> None:
        self._question, self._stops, self._computed_s = question, 0, 0.0

    def _heard(self, kind: str, found: Any) -> None:
        if kind == "computed":
            self._computed_s = found
        else:
            super()._heard(kind, found)

    def _more(self) -> dict[str, Any]:
        """What it has computed, and what the search may."""
        if self._question is None:
            return {}
        return {"computed_s": round(self._computed_s, 1), "budget_s": self._question.budget_s}

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
                self._words = f"stopping: {SO_FAR}"

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
