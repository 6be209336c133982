"""What every virtual node has in common: a thread with a bus of its own, counters, answers to requests."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping

import can

from scenarios.bench.faults import FaultyBus
from scenarios.bench.messages import Frame, messages

POLL_S = 0.1
"""How long a node waits for a frame before it looks whether to stop [s]."""
RECOVERY_S = 0.05
"""Pause between two attempts to get back on the bus [s]."""


class Node(threading.Thread):
    """Handles frames one after the other; frames with a wrong checksum are not for it."""

    def __init__(self, name: str, bus: FaultyBus) -> None:
        super().__init__(name=name, daemon=True)
        self.bus = bus
        self.failure: Exception | None = None
        self._stopping = threading.Event()
        self._counters: dict[str, int] = {}

    def handlers(self) -> Mapping[str, Callable[[Frame], None]]:
        """What to do on which message."""
        raise NotImplementedError

    def run(self) -> None:
        """Answer until stopped."""
        known = self.handlers()
        # Decoding is the dearest step: only what this node answers to is decoded.
        answered = {messages().by_name[name].frame_id for name in known}
        try:
            while not self._stopping.is_set():
                try:
                    message = self.bus.recv(POLL_S)
                    if message is None or message.arbitration_id not in answered:
                        continue
                    frame = messages().decode(message)
                    if frame is not None and frame.sound:
                        known[frame.name](frame)
                except can.CanError:
                    self._recover()
        except Exception as error:
            # A node's own mistake must reach who waits for it, not end in a thread that nobody joins.
            self.failure = error
        finally:
            self.bus.shutdown()

    def stop(self) -> None:
        """Ask the node to end; join it afterwards."""
        self._stopping.set()

    def say(self, name: str, **values: float) -> None:
        """Send a frame of this node's under its next counter."""
        count = self._counters.get(name, 0)
        self._counters[name] = count + 1
        self.bus.send(messages().encode(name, values, count))

    def _recover(self) -> None:
        while not self._stopping.is_set():
            try:
                self.bus.reopen()
                return
            except can.CanError:
                time.sleep(RECOVERY_S)
