"""Watching a search: what it tells of itself while it runs, and the word that ends it where it stands."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, TypeVar

from diagnosis.progress import Listener, Progress
from twin.log import LOG

S = TypeVar("S")


class Stopped(KeyboardInterrupt):
    """The search is to end where it stands: an interrupt, which all code that guards others' code lets pass."""


class Watch:
    """Hears where a search stands, hands it on to a listener, and ends the search when asked to.

    ``stopped_in`` is the stage that was cut short or never begun; None where the search came to its own end.
    """

    def __init__(self, listener: Listener | None = None) -> None:
        self.stopped_in: str | None = None
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
        if self.stopped_in is None and not self._over:
            self.stopped_in = self._stage
        if not self._asked_to_stop:
            self._asked_to_stop = True
            # At once: what is left to do takes seconds, in which a person asks whether the word was heard.
            with suppress(StopIteration):
                self._tell()
        if self._searching:
            raise Stopped

    def until_stopped(self, search: Callable[[S], S], state: S) -> S:
        """The state that a search ends with; the one last told of where it is stopped before."""
        if self.stopped_in is not None:
            return state
        self._as_it_stands = lambda: state
        try:
            self._searching, self._over = True, False
            found = search(state)
            self._searching, self._over = False, True
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
