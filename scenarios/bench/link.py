"""The bench's own end of the bus: sends, receives, keeps a log of both, and gets back on after bus-off."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import can

from scenarios.bench.bus_log import BusLog
from scenarios.bench.faults import FaultyBus, Opener
from scenarios.bench.messages import SEQUENCES, Frame, messages
from scenarios.bench.readings import Collector, Event
from twin.errors import UserError

RECOVERY_S = 0.05
RECOVERIES = 100
"""How long and how often the bench tries to get back on a bus that went off."""


class Link:
    """One bus, one assembler. Every frame that was sent or received passes the assembler and the log, in order."""

    def __init__(
        self, open_bus: Opener, assembler: Collector[Any], record: Path | None = None, *, replace: bool = False
    ) -> None:
        self._open = open_bus
        self._bus = open_bus()
        self.assembler = assembler
        try:
            self._log = None if record is None else BusLog(record, replace=replace)
        except BaseException:
            self._bus.shutdown()
            raise
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
        try:
            if self._log is not None:
                self._log.close()
        finally:
            self._bus.shutdown()

    def _write(self, message: can.Message) -> None:
        if self._log is not None:
            # Sent frames have no stamp of their own; logs want one order of time.
            message.timestamp = time.time()
            self._log.write(message)

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
