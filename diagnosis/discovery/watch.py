"""Watching a search: what it tells of itself while it runs, and the word that ends it where it stands."""

from __future__ import annotations

import math
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, Literal, TypeVar

from diagnosis.progress import Listener, Progress
from twin.log import LOG

S = TypeVar("S")
EndedBy = Literal["interrupt", "budget"]
"""What ends a search where it stands: somebody's word, or that the computing time given to it is spent."""


class Stopped(KeyboardInterrupt):
    """The search is to end where it stands: an interrupt, which all code that guards others' code lets pass."""


class Watch:
    """Hears where a search stands, hands it on to a listener, and ends the search when asked to.

    ``stopped_in`` is the stage that was cut short or never begun, and ``ended_by`` what did it; None where the search
    came to its own end. ``budget_s`` is the computing time of this thread, from here on, at which it is ended. What is
    computed is counted and not what the clock on the wall shows: waiting for a busy machine costs nothing.
    """

    def __init__(self, listener: Listener | None = None, *, budget_s: float = math.inf) -> None:
        self.stopped_in: str | None = None
        self.ended_by: EndedBy | None = None
        self._spent_at_s = time.thread_time() + budget_s
        self._listener = listener
        self._began_s = time.monotonic()
        self._stage = ""
        self._told: tuple[str, tuple[str, ...]] = ("", ())
        self._asked_to_stop = False
        self._searching = False
        self._over = False
        self._as_it_stands: Callable[[], Any] | None = None

    def told(self, stage: str, causes: Sequence[str], as_it_stands: Callable[[], Any] | None = None) -> None:
        """Hear that a stage runs with these causes held, and from which state to go on where it is stopped.

        A listener that raises StopIteration, as a callback of scipy.optimize may, stops the search.
        """
        if self._told != (stage, tuple(causes)):
            self._told = stage, tuple(causes)
            LOG.info("stage %s; held so far: %s", stage, ", ".join(causes) or "no cause")
        self._stage = stage
        if as_it_stands is not None:
            self._as_it_stands = as_it_stands
        if self._searching and self.stopped_in is not None:
            # Code of the user's own has caught what was raised in it.
            raise Stopped
        self.end_if_spent()
        try:
            self._tell()
        except StopIteration:
            self.stop()

    def _tell(self) -> None:
        """Tell the listener where the search stands."""
        if self._listener is not None:
            elapsed_s = time.monotonic() - self._began_s
            self._listener(Progress(self._stage, elapsed_s, causes=self._told[1], stopped=self._asked_to_stop))

    def stop(self) -> None:
        """End the search where it stands, do not begin it; where it is over already, change nothing."""
        self._end("interrupt")
        if self.ended_by == "budget":
            # Whoever asks for the end is to be told that it was heard, also where the budget has made it before.
            self.ended_by = "interrupt"
        if not self._asked_to_stop:
            self._asked_to_stop = True
            # At once: what is left to do takes seconds, in which a person asks whether the word was heard.
            with suppress(StopIteration):
                self._tell()
        if self._searching:
            raise Stopped

    @property
    def left_s(self) -> float:
        """What is left of the budget."""
        return self._spent_at_s - time.thread_time()

    def end_if_spent(self) -> None:
        """End the search where it stands, or do not begin it, once the budget is spent."""
        if self.left_s > 0.0 or self._over:
            return
        self._end("budget")
        if self._searching:
            raise Stopped

    def _end(self, by: EndedBy) -> None:
        if self.stopped_in is None and not self._over:
            self.stopped_in, self.ended_by = self._stage, by

    def until_stopped(self, search: Callable[[S], S], state: S) -> S:
        """The state that a search ends with; the one last told of where it is stopped before."""
        if self.stopped_in is not None:
            return state
        self._as_it_stands = lambda: state
        try:
            self._searching, self._over = True, False
            found = search(state)
            # In this order: what ends a search between the two must find it over.
            self._over = True
            self._searching = False
        except Stopped:
            self._searching = False
            found = self._as_it_stands()
        return found


@contextmanager
def stopped_by_interrupt(watch: Watch) -> Iterator[None]:
    """The first interrupt (Ctrl-C) ends the search where it stands; a second one is as ever.

    Where interrupts are ignored, or in a thread, which gets none, nothing changes.
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or before in (signal.SIG_IGN, None):
        yield
        return

    def first(number: int, frame: Any) -> None:
        signal.signal(signal.SIGINT, before)
        watch.stop()

    signal.signal(signal.SIGINT, first)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


_LOOKED_AT_S = 0.05
"""From one look at the budget to the next, at least: the process may have computed in other threads too."""
_LOOKED_AT_LATEST_S = 1e6
"""And at most: systems refuse a timer of centuries."""


@contextmanager
def ended_by_budget(watch: Watch) -> Iterator[None]:
    """A search ends within a stage too, as soon as its budget is spent.

    In a thread, on a system without interval timers, or under a profiler that uses the one of the process, it ends when
    the stage next tells where it stands.
    """
    if sys.platform == "win32" or threading.current_thread() is not threading.main_thread():
        yield
        return
    if not math.isfinite(watch.left_s) or signal.getsignal(signal.SIGPROF) is not signal.SIG_DFL:
        yield
        return

    def look(number: int, frame: Any) -> None:
        if watch.left_s > 0.0:
            signal.setitimer(signal.ITIMER_PROF, _wait_s(watch))
        watch.end_if_spent()

    try:
        signal.signal(signal.SIGPROF, look)
        signal.setitimer(signal.ITIMER_PROF, _wait_s(watch))
        yield
    finally:
        # A tick that is under way as the timer goes would set it anew, and then end the program.
        signal.signal(signal.SIGPROF, signal.SIG_IGN)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, signal.SIG_DFL)


def _wait_s(watch: Watch) -> float:
    """How long to wait for the next look: what is left, within what a timer takes."""
    return min(max(watch.left_s, _LOOKED_AT_S), _LOOKED_AT_LATEST_S)
