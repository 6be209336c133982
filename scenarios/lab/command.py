"""``halltwin lab``: serve the page until Ctrl-C."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import tempfile
import threading
import webbrowser
from collections.abc import Iterator
from pathlib import Path

from scenarios.lab import sweeps, twins
from scenarios.lab.server import Server
from scenarios.lab.session import Session
from twin.errors import UserError
from twin.limits import require_within


def run(sweep: str | None, *, twin: str | None, port: int, browser: bool) -> None:
    """The command. Ctrl-C is its only end, and so none of a failure. Raises UserError."""
    require_within("port", port, 0, 65535, whole=True)
    sensor = twins.named(twin or twins.DEFAULT)
    recording = None if sweep is None else sweeps.named(sweep)
    with tempfile.TemporaryDirectory(prefix="halltwin-lab-") as folder:
        session = Session(sensor, Path(folder), sweep=recording, held=twin is not None)
        with (
            contextlib.closing(session),
            _listening(session, port) as server,
            # From before the page is told of: whoever waits for its address may end it at once.
            contextlib.suppress(KeyboardInterrupt),
            _ended_by(signal.SIGTERM),
        ):
            print(started(server.guard.url), flush=True)
            if browser and _has_screen():
                # Not the secret itself: what a command is given, all users of the machine can list.
                address = f"{server.guard.origin}{server.door.path}"
                threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
            server.serve_forever(poll_interval=0.2)


def started(url: str) -> str:
    """What is printed once the page is served."""
    return f"the page is at {url}\nonly this machine can open it; Ctrl-C ends it"


@contextlib.contextmanager
def _ended_by(number: int) -> Iterator[None]:
    """A signal ends what is within as SystemExit does, with the exit code of a program that it ends."""

    def end(*_: object) -> None:
        raise SystemExit(128 + number)

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(number, end)
    try:
        yield
    finally:
        signal.signal(number, before)


def _listening(session: Session, port: int) -> Server:
    """The server at its port. Raises UserError where that is taken."""
    try:
        return Server(session.routes(), port=port)
    except OSError as error:
        raise UserError(
            f"port {port}: cannot be listened at ({error.strerror}); give another, or none for a free one"
        ) from None


def _has_screen() -> bool:
    """Whether a browser would open a window; without a screen it would take the terminal instead."""
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
