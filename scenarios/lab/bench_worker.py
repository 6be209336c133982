"""The process that runs the closed loop on the virtual bench for the page: ``halltwin bench --closed-loop`` itself."""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from scenarios.bench.readings import Reading

_TOLD_EVERY_S = 0.1
OUTPUT, REPORT = "bench.csv", "bench-report.json"


@dataclass(frozen=True, kw_only=True)
class Loop:
    """What is measured: the encoder's twin, what is hidden in it, angles a turn; ``folder`` takes the files."""

    twin: str
    hide: tuple[str, ...]
    points: int
    seed: int
    command: str
    folder: Path


def work(line: Connection, loop: Loop) -> None:
    """Run the loop. Beside the messages of a job: ``curve`` with the errors so far of one of both sweeps."""
    if hasattr(os, "setsid"):
        # Ctrl-C in the terminal is the server's to answer.
        os.setsid()
    from scenarios.bench.command import Options, run
    from twin.errors import UserError

    options = Options(
        output=loop.folder / OUTPUT,
        closed_loop=True,
        twin=loop.twin,
        hide=loop.hide,
        points=loop.points,
        seed=loop.seed,
        command=loop.command,
        heard=_Curve(line, 2 * loop.points),
    )
    try:
        # The terminal is the server's.
        with contextlib.redirect_stdout(_Said(line)), open(os.devnull, "w") as none, contextlib.redirect_stderr(none):
            run(options)
        line.send(("answer", json.loads((loop.folder / REPORT).read_text(encoding="utf-8"))))
    except UserError as error:
        line.send(("error", str(error).replace(f"{loop.folder}{os.sep}", "")))
    except BrokenPipeError:
        return
    except Exception:
        traceback.print_exc(file=sys.__stderr__)
        line.send(("error", "this is a fault of the program; the terminal says more"))


class _Said(io.TextIOBase):
    """Hands on what the command prints, line by line."""

    def __init__(self, line: Connection) -> None:
        self._line, self._held = line, ""

    def write(self, text: str) -> int:
        """See io."""
        *whole, self._held = (self._held + text).split("\n")
        for words in filter(None, whole):
            self._line.send(("said", words))
        return len(text)


class _Curve:
    """Hands on the errors of the readings so far, several times a second and at the last."""

    def __init__(self, line: Connection, total: int) -> None:
        self._line, self._total, self._told_s = line, total, 0.0

    def __call__(self, name: str, readings: Sequence[Reading]) -> None:
        from scenarios.bench.closed_loop import direct_errors_deg
        from scenarios.bench.pretreatment import errors_deg

        now = time.monotonic()
        if now - self._told_s < _TOLD_EVERY_S and len(readings) < self._total:
            return
        self._told_s = now
        corrected = "-after" in name
        error = direct_errors_deg(readings) if corrected else errors_deg(readings)
        told: dict[str, Any] = {
            "part": "after" if corrected else "before",
            "at_deg": [round(one.reference_deg % 360.0, 3) for one in readings],
            "error_deg": error.round(5).tolist(),
            "total": self._total,
        }
        self._line.send(("curve", told))
