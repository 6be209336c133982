"""The bench's own end of the bus: sends, receives, keeps a log of both, and gets back on after bus-off."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import can

from scenarios.bench.faults import FaultyBus, Opener
from scenarios.bench.messages import SEQUENCES, Frame, messages
from scenarios.bench.readings import Assembler, Event
from twin.errors import UserError

LOG_FORMATS = (".asc", ".blf", ".csv", ".db", ".log", ".trc")
"""Formats of python-can that hold every frame whole, without further packages."""
RECOVERY_S = 0.05
RECOVERIES = 100
"""How long and how often the bench tries to get back on a bus that went off."""


class Link:
    """One bus, one assembler. Every frame that was sent or received passes the assembler and the log, in order."""

    def __init__(
        self, open_bus: Opener, assembler: Assembler, record: Path | None = None, *, replace: bool = False
    ) -> None:
        self._open = open_bus
        self._bus = open_bus()
        self.assembler = assembler
        self._record = record
        self._log: Any = None if record is None else open_log(record, replace=replace)
        self._sequence = 0
        # An interface may hand back what it sent itself.
        self._own = {messages().by_name[name].frame_id for name in messages().sent_by("Bench")}

    def next_sequence(self) -> int:
        """A number for a request that no answer on its way still carries."""
        self._sequence = (self._sequence + 1) % SEQUENCES
        return self._sequence

    def send(self, name: str, values: Mapping[str, float]) -> None:
        """Send one frame. Raises UserError where the bus stays off."""
        message = messages().encode(name, values)
        message.is_rx = False
        self._kept_on(lambda: self._bus.send(message))
        self.assembler.feed(message)
        self._write(message)

    def receive(self, timeout_s: float) -> Frame | None:
        """The next frame that can be trusted; None when the time is up."""
        end = time.monotonic() + timeout_s
        while (left := end - time.monotonic()) > 0.0:
            message = self._kept_on(partial(self._receive, left))
            if message is None or message.arbitration_id in self._own:
                continue
            self._write(message)
            frame = self.assembler.feed(message)
            if frame is not None:
                return frame
        return None

    def _receive(self, timeout_s: float) -> can.Message | None:
        return self._bus.recv(timeout_s)

    def close(self) -> None:
        """Close log and bus. Raises UserError where the log could not be written to its end."""
        log, self._log = self._log, None
        try:
            if log is not None:
                with self._log_told():
                    log.stop()
        finally:
            self._bus.shutdown()

    def _write(self, message: can.Message) -> None:
        if self._log is None:
            return
        # Sent frames have no stamp of their own; logs want one order of time.
        message.timestamp = time.time()
        log = self._log
        with self._log_told():
            # A log that failed once fails when it is closed, too.
            self._log = None
            log.on_message_received(message)
            self._log = log

    @contextlib.contextmanager
    def _log_told(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise UserError(f"{self._record}: cannot be written ({error.strerror or error}); make room") from None

    def _kept_on(self, action: Callable[[], Any]) -> Any:
        for attempt in range(RECOVERIES):
            try:
                if attempt:
                    self._reopen()
                return action()
            except can.CanError as error:
                if attempt == 0:
                    self.assembler.counts["bus off"] += 1
                    self.assembler.on_event(Event(f"bus off: {error}", "", None))
                time.sleep(RECOVERY_S)
        raise UserError(f"the bus stays off after {RECOVERIES} attempts to open it again; check adapter and wiring")

    def _reopen(self) -> None:
        if isinstance(self._bus, FaultyBus):
            self._bus.reopen()
            return
        self._bus.shutdown()
        self._bus = self._open()


def open_log(path: Path, *, replace: bool = False) -> Any:
    """A log of python-can that writes to this file. Raises UserError for a format that cannot hold the frames."""
    check_log_name(path)
    if replace:
        # Some formats would go on in a file that is there.
        path.unlink(missing_ok=True)
    if path.exists():
        raise UserError(f"{path}: there is such a file; a log is not written over: give another name")
    return can.Logger(str(path))


def check_log_name(path: Path) -> None:
    """Raise UserError where python-can cannot tell the format by the name."""
    if path.suffix not in LOG_FORMATS:
        raise UserError(f"{path.name}: bus logs end in {', '.join(LOG_FORMATS)}; found '{path.suffix}'")
