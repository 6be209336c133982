"""Ctrl-C during long work: one line that says how to go on, and the exit code that shells have for it."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator

from scenarios.commands.progress import INTERRUPTED


@contextlib.contextmanager
def interruptible(kept: Callable[[], str]) -> Iterator[None]:
    """Ctrl-C within ends the program with one line on stderr; ``kept`` says what is kept and how to go on."""
    try:
        yield
    except KeyboardInterrupt:
        print(f"halltwin: interrupted; {kept()}", file=sys.stderr)
        raise SystemExit(INTERRUPTED) from None
