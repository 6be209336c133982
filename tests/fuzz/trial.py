"""One trial: a call under a clock, which may answer or refuse in one line, and nothing else."""

from __future__ import annotations

import contextlib
import re
import resource
import signal
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from twin.errors import UserError

LONGEST_S = 60
"""No run of an input of ordinary size takes longer."""
TIMES_THE_MEMORY = 10
"""Nor has the process ever more than so many times the memory of a plain run."""
LONGEST_LINE = 1500
STATUS = Path("/proc/self/status")

ANSWERED, REFUSED, FAILED = "answered", "refused", "failed"


class OverTimeError(BaseException):
    """The time is up; nothing but the trial catches it."""


@dataclass(frozen=True)
class Ended:
    """How a trial ended, and what was said: the line of a refusal, or the traceback of a failure."""

    how: str
    said: str = ""


@contextlib.contextmanager
def within(seconds: float) -> Iterator[None]:
    """Raise OverTimeError in the body after so much computing, or ten times as long by the clock."""

    def over(number: int, frame: FrameType | None) -> None:
        raise OverTimeError(f"took more than {seconds:g} s")

    clocks = ((signal.SIGPROF, signal.ITIMER_PROF, seconds), (signal.SIGALRM, signal.ITIMER_REAL, 10.0 * seconds))
    previous = [signal.signal(number, over) for number, _, _ in clocks]
    for _, timer, most in clocks:
        signal.setitimer(timer, most)
    try:
        yield
    finally:
        for (number, timer, _), handler in zip(clocks, previous, strict=True):
            signal.setitimer(timer, 0.0)
            signal.signal(number, handler)


def tried(call: Callable[[], object], *, seconds: float = LONGEST_S) -> Ended:
    """Run a call that answers or raises UserError; all else is a failure, a refusal of several lines too."""
    try:
        with within(seconds):
            call()
    except UserError as refusal:
        said = str(refusal)
        if len(said) > LONGEST_LINE:
            return Ended(FAILED, f"a line of {len(said)} characters: {said[:500]}")
        return Ended(REFUSED, said)
    except (Exception, SystemExit, OverTimeError):
        return Ended(FAILED, traceback.format_exc())
    return Ended(ANSWERED)


def peak_mb() -> float:
    """The most memory that this process has ever held.

    On Linux getrusage counts that of the process that started this one too, so the kernel is asked for its own.
    """
    status = STATUS.read_text(encoding="ascii", errors="replace") if STATUS.exists() else ""
    own_kb = re.search(r"^VmHWM:\s*(\d+) kB$", status, re.M)
    if own_kb is not None:
        return int(own_kb[1]) / 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


@dataclass
class MemoryWatch:
    """Whether an input made the process larger than so many times what a plain run takes."""

    plain_mb: float
    highest_mb: float = 0.0

    def judged(self, ended: Ended) -> Ended:
        """The end of a trial, or a failure where the process has grown beyond the limit meanwhile."""
        before, self.highest_mb = self.highest_mb, peak_mb()
        limit = TIMES_THE_MEMORY * self.plain_mb
        if before <= limit < self.highest_mb and ended.how != FAILED:
            return Ended(FAILED, f"took {self.highest_mb:.0f} MB, a plain run {self.plain_mb:.0f} MB")
        return ended
