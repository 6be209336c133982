"""How far a study is: a bar on a terminal, elsewhere a plain line now and then."""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from scenarios.commands.progress import duration

FIRST_S, SHARE = 10.0, 0.1
"""Without a terminal the first line comes after so many seconds, each further one after a tenth of the time so far
or after as many seconds again: a log of an hour has some forty lines."""


@dataclass
class Course:
    """How many of ``chunks`` chunks are complete, of which ``before`` were so at the start."""

    chunks: int
    before: int
    items: int
    unit: str
    done: int = 0

    def line(self, elapsed_s: float) -> str:
        """The state in words, with the rate and the time left."""
        each = self.items / self.chunks
        reached = round((self.before + self.done) * each)
        said = f"halltwin: after {duration(elapsed_s)}: {reached:,} of {self.items:,} {self.unit}"
        if not self.done:
            return said
        rate = self.done * each / elapsed_s
        left = (self.chunks - self.before - self.done) * elapsed_s / self.done
        return f"{said}, {rate:.3g} {self.unit}/s, {duration(left)} left"


@contextlib.contextmanager
def progress(chunks: int, done: int, items: int, unit: str) -> Iterator[Callable[[], None]]:
    """A function to call after each chunk. All ``chunks`` hold ``items`` things named ``unit``; ``done`` are there."""
    from rich.console import Console

    console = Console(stderr=True)
    course = Course(chunks, done, items, unit)
    with _bar(console, course) if console.is_terminal else _lines(course) as step:
        yield step


@contextlib.contextmanager
def _lines(course: Course) -> Iterator[Callable[[], None]]:
    """Lines on stderr, from a thread of their own: a chunk may take minutes."""
    start, over = time.monotonic(), threading.Event()

    def tell() -> None:
        pause_s = FIRST_S
        while not over.wait(pause_s):
            elapsed_s = time.monotonic() - start
            print(course.line(elapsed_s), file=sys.stderr, flush=True)
            pause_s = max(FIRST_S, SHARE * elapsed_s)

    def step() -> None:
        course.done += 1

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield step
    finally:
        over.set()
        teller.join()


@contextlib.contextmanager
def _bar(console: object, course: Course) -> Iterator[Callable[[], None]]:
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn(course.unit),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    each = course.items / course.chunks
    with Progress(*columns, console=console) as shown:  # type: ignore[arg-type]
        task = shown.add_task(course.unit, total=course.items, completed=round(course.before * each), rate="")

        def step() -> None:
            shown.advance(task, each)
            speed = shown.tasks[0].speed
            shown.update(task, rate="" if not speed else f"{speed:,.0f} {course.unit}/s")

        yield step
