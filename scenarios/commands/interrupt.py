"""Ctrl-C: one line that says what is kept and how to go on, and the exit code that shells have for it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

INTERRUPTED = 130
"""Exit code of a command that Ctrl-C has ended or cut short, as of any program that an interrupt ends."""
NOTHING_WRITTEN = "interrupted; nothing was written"


class Interrupted(Exception):
    """Ctrl-C has ended a command; the message is the line to end with."""


@contextlib.contextmanager
def interruptible(kept: Callable[[], str] | None = None) -> Iterator[None]:
    """Ctrl-C within ends the command; ``kept`` says what is kept and how to go on, without it nothing is.

    Raises Interrupted.
    """
    try:
        yield
    except KeyboardInterrupt:
        raise Interrupted(NOTHING_WRITTEN if kept is None else f"interrupted; {kept()}") from None
