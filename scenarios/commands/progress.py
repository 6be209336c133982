"""What a person sees while a command works: one line on stderr that comes after two seconds and goes at the end.

The line is live, and shown on a terminal alone: scripts stay quiet, and a log gets its lines by ``--verbose``.
"""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Timer
from typing import TYPE_CHECKING

from diagnosis.progress import Listener, Progress
from diagnosis.report.stage_words import progress_words
from twin.log import LOG

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

SHOWN_AFTER_S = 2.0

Clock = Callable[[], float]


@contextmanager
def progress_line(
    hint: str = "", *, console: Console | None = None, clock: Clock = time.monotonic
) -> Iterator[Listener]:
    """A listener that shows where a call stands; ``hint`` says what Ctrl-C does."""
    from rich.console import Console

    console = console or Console(file=sys.stderr, highlight=False, soft_wrap=True)
    # --verbose says all of it already, line by line.
    if LOG.isEnabledFor(logging.INFO) or not console.is_terminal or console.is_dumb_terminal:
        yield _Stop(console).hear
        return
    line = _Live(console, hint, clock)
    try:
        yield line.hear
    finally:
        line.end()


class _Stop:
    """Where there is no live line: one line as soon as the search is stopped, and nothing else."""

    def __init__(self, console: Console) -> None:
        self._console, self._said = console, False

    def hear(self, progress: Progress) -> None:
        """Say once that the word to stop was heard."""
        if progress.stopped and not self._said:
            self._said = True
            self._console.print("halltwin: stopping: the answer so far follows; Ctrl-C again ends at once")


class _Live:
    """One live line, from two seconds on; it goes when the work is done."""

    def __init__(self, console: Console, hint: str, clock: Clock) -> None:
        from rich.live import Live

        self._hint, self._clock, self._began_s = hint, clock, clock()
        self._said = ""
        # What else is printed meanwhile goes where it would go without the line.
        self._live = Live(
            console=console,
            get_renderable=self.line,
            transient=True,
            refresh_per_second=4,
            redirect_stdout=False,
            redirect_stderr=False,
        )
        self._timer = Timer(SHOWN_AFTER_S, self._live.start)
        self._timer.daemon = True
        self._timer.start()

    def hear(self, progress: Progress) -> None:
        """Remember what to show."""
        self._said = progress_words(progress, self._hint)

    def line(self) -> RenderableType:
        """The line as it stands now, cut at the edge of the terminal."""
        from rich.text import Text

        elapsed = duration(self._clock() - self._began_s)
        return Text.assemble((elapsed, "bold"), f"  {self._said}", no_wrap=True, overflow="ellipsis")

    def end(self) -> None:
        """Take the line away, or see to it that it does not come any more."""
        self._timer.cancel()
        self._timer.join()
        self._live.stop()


def duration(seconds: float) -> str:
    """A time in whole seconds, or in minutes and seconds."""
    whole = int(seconds)
    return f"{whole} s" if whole < 60 else f"{whole // 60} min {whole % 60:02d} s"
