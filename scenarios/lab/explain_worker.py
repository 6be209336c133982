"""The process that explains a sweep for the page: the search as the command line has it, then its layers on request.

A process of its own, so that the page stays at hand meanwhile, a search can be stopped as by Ctrl-C, and what it holds
goes with it.
"""

from __future__ import annotations

import os
import signal
import sys
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

_TOLD_EVERY_S = 0.2
SO_FAR = "the answer so far follows; stop again to have none"
"""What comes of a search that is stopped once."""


@dataclass(frozen=True, kw_only=True)
class Question:
    """A sweep's file and the name it is called by, the twin it is held against, where the files of the answer go."""

    sweep: Path
    name: str
    twin: str | None
    command: str
    budget_s: float
    seed: int
    folder: Path


ANSWER, REPORT, EXTENDED = "answer.json", "report.html", "extended.toml"


def work(line: Connection, question: Question) -> None:
    """Explain, then answer to looks until the other end hangs up.

    Sent are pairs: ``progress`` with words, ``computed`` with seconds, ``error`` with a line, ``answer`` with plain
    values, ``look`` likewise.
    """
    if hasattr(os, "setsid"):
        # Ctrl-C in the terminal is the server's to answer.
        os.setsid()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    from scenarios.lab.dropped import as_called
    from twin.errors import UserError

    try:
        explained = _explained(question, _Telling(line))
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        layers, answer = _answered(question, explained)
    except KeyboardInterrupt:
        line.send(("error", "stopped before anything was found"))
        return
    except UserError as error:
        line.send(("error", str(as_called(error, question.sweep, question.name))))
        return
    except BrokenPipeError:
        return
    except Exception:
        traceback.print_exc()
        line.send(("error", "this is a fault of the program, not of the sweep; the terminal says more"))
        return
    line.send(("answer", answer))
    _serve(line, layers)


class _Telling:
    """Hands on where the search stands and what it has computed, a few times a second."""

    def __init__(self, line: Connection) -> None:
        self._line, self._told_s = line, 0.0
        # As the budget counts: of this thread alone, and no waiting for a busy machine.
        self._began_s = time.thread_time()

    def __call__(self, progress: Any) -> None:
        from diagnosis.report.stage_words import progress_words

        now = time.monotonic()
        if now - self._told_s > _TOLD_EVERY_S or progress.stopped:
            self._told_s = now
            self._line.send(("computed", time.thread_time() - self._began_s))
            self._line.send(("progress", f"finishing: {SO_FAR}" if progress.stopped else progress_words(progress)))


def _explained(question: Question, listener: Callable[[Any], None]) -> Any:
    """The answer, as the command line would have it. Raises UserError."""
    from diagnosis import explain
    from scenarios.commands.inputs import SweepFiles
    from twin.extensions import effects_with
    from twin.presets import read_twin_or_preset

    held = None if question.twin is None else read_twin_or_preset(question.twin, effects=effects_with())
    read = SweepFiles([str(question.sweep)]).recording(question.sweep, name=question.name)
    found = explain(
        read,
        twin=held,
        seed=question.seed,
        budget_s=question.budget_s,
        progress=listener,
        on_interrupt="answer",
    )
    return replace(found, made=replace(found.made, command=question.command))


def _answered(question: Question, explained: Any) -> tuple[Any, dict[str, Any]]:
    """The layers, and what the page is told; the files of the answer are written."""
    from scenarios.commands.explain import Outputs, contents_of
    from scenarios.commands.outputs import HTML, JSON, TOML, OutputFiles
    from scenarios.lab.layers import Layers
    from scenarios.lab.told import told_of

    paths = {name: question.folder / name for name in (ANSWER, REPORT, EXTENDED)}
    outputs = Outputs(json=paths[ANSWER], report=paths[REPORT], extended=paths[EXTENDED])
    files = OutputFiles.checked([(paths[ANSWER], JSON), (paths[REPORT], HTML), (paths[EXTENDED], TOML)])
    plain = explained.to_dict()
    contents = contents_of(explained, plain, outputs)
    files.write({path: contents[path] for path in paths.values()})
    layers = Layers(explained)
    return layers, {**told_of(plain), **layers.told(), "command": question.command}


def _serve(line: Connection, layers: Any) -> None:
    """Answer to looks until the other end hangs up."""
    from scenarios.lab.layers import look_of
    from twin.errors import UserError

    while True:
        try:
            content = line.recv()
        except (EOFError, OSError):
            return
        try:
            line.send(("look", layers.look(look_of(content))))
        except UserError as error:
            line.send(("error", str(error)))
        except Exception as fault:
            sys.excepthook(type(fault), fault, fault.__traceback__)
            line.send(("error", "this is a fault of the program, not of the sweep; the terminal says more"))
