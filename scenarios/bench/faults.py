"""Faults on purpose: a bus that loses, repeats and spoils frames, falls silent, stands still or goes off."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import can
import numpy as np

from scenarios.bench.messages import messages, with_byte_flipped, with_counter
from twin.errors import UserError
from twin.known_names import nearest
from twin.limits import require_within
from twin.shown import shown

NODES = ("stepper", "reference", "hall", "chamber")
AFTER_FRAMES = 200
"""Faults that happen once begin after a node has sent this many frames."""
_SHARES = ("lost", "duplicated", "checksum")
_HALL = ("wild", "spi")
_ONCE = {"silent": 1.0, "gone": AFTER_FRAMES, "stuck": 20.0, "bus_off": 0.5}
_DEFAULT_SHARE = 0.01
_ANGLE_HIGH_BYTE, _QUARTER_TURN = 3, 0x40
"""The bit of HallAngle that is worth 90 deg."""


class Bus(Protocol):
    """What the bench needs of a python-can bus."""

    def send(self, msg: can.Message, timeout: float | None = None) -> None: ...
    def recv(self, timeout: float | None = None) -> can.Message | None: ...
    def shutdown(self) -> None: ...


Opener = Callable[[], Bus]


@dataclass(frozen=True)
class Fault:
    """One fault of one node.

    ``lost``, ``duplicated``, ``checksum``: share of its frames. ``wild``, ``spi``: share of the Hall encoder's angles
    that are 90 deg off under a right checksum, or whose SPI frame has a wrong bit. Once each, from its 200th frame on:
    ``silent`` (seconds), ``stuck`` (frames under one counter), ``bus_off`` (seconds). ``gone``: after so many frames.
    """

    kind: str
    node: str
    value: float


def parse(text: str) -> tuple[Fault, ...]:
    """KIND[:NODE][=VALUE], without a node for all of them. Raises UserError."""
    head, _, given = text.partition("=")
    kind, _, node = head.partition(":")
    kinds = (*_SHARES, *_HALL, *_ONCE)
    if kind not in kinds:
        raise UserError(f"fault {shown(text)}: unknown kind{nearest(kind, kinds)}; expected one of {', '.join(kinds)}")
    known = ("hall",) if kind in _HALL else (*NODES, "bench") if kind in (*_SHARES, "bus_off") else NODES
    if node and node not in known:
        raise UserError(f"fault {shown(text)}: unknown node{nearest(node, known)}; expected one of {', '.join(known)}")
    if not node and kind in _ONCE:
        raise UserError(f"fault {shown(text)}: says not whose; expected {kind}:NODE, one of {', '.join(known)}")
    try:
        value = float(given) if given else _ONCE.get(kind, _DEFAULT_SHARE)
    except ValueError:
        raise UserError(f"fault {shown(text)}: {shown(given)} is not a number") from None
    require_within(f"fault {kind}", value, 0.0, 1e9 if kind in _ONCE else 1.0)
    return tuple(Fault(kind, one, value) for one in ((node,) if node else known))


@dataclass(eq=False)
class FaultyBus:
    """A node's bus with faults on what it sends; ``done`` counts them by kind."""

    open_bus: Opener
    faults: Sequence[Fault]
    rng: np.random.Generator
    done: Counter[str] = field(default_factory=Counter)
    _sent: int = 0
    _last: dict[int, int] = field(default_factory=dict)
    _started: dict[str, float] = field(default_factory=dict)
    _bus: Bus = field(init=False)

    def __post_init__(self) -> None:
        self._bus = self.open_bus()

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send, or do what the faults do instead."""
        self._sent += 1
        if self._off():
            raise can.CanOperationError("bus off")
        if self._mute():
            return
        message = self._counted(msg)
        drawn = (*_SHARES, "wild") if messages().name_of(msg) == "HallAngle" else _SHARES
        draw = dict(zip(drawn, self.rng.random(len(drawn)), strict=True))
        hit = [fault.kind for fault in self.faults if fault.kind in draw and draw[fault.kind] < fault.value]
        self.done.update(hit)
        if "lost" in hit:
            return
        if "wild" in hit:
            message = with_byte_flipped(message, _ANGLE_HIGH_BYTE, _QUARTER_TURN)
        if "checksum" in hit:
            data = bytearray(message.data)
            data[int(self.rng.integers(len(data)))] ^= 1 << int(self.rng.integers(8))
            message = can.Message(arbitration_id=msg.arbitration_id, data=data, is_extended_id=False)
        self._bus.send(message, timeout)
        if "duplicated" in hit:
            self._bus.send(message, timeout)

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """Receive; a silent node also hears nothing."""
        message = self._bus.recv(timeout)
        if self._off():
            raise can.CanOperationError("bus off")
        return None if self._mute(count=False) else message

    def shutdown(self) -> None:
        """Close the bus."""
        self._bus.shutdown()

    def reopen(self) -> None:
        """As a controller does after bus-off; does not help before the cause is over."""
        if self._off():
            raise can.CanOperationError("bus off")
        self._bus.shutdown()
        self._bus = self.open_bus()

    def _since(self, kind: str) -> float:
        """Seconds since a fault began, beginning it where it is due."""
        if self._sent <= AFTER_FRAMES:
            return -1.0
        return time.monotonic() - self._started.setdefault(kind, time.monotonic())

    def _off(self) -> bool:
        return any(
            f.kind == "bus_off" and 0.0 <= self._since(f.kind) < f.value and self._tick(f.kind) for f in self.faults
        )

    def _mute(self, *, count: bool = True) -> bool:
        for fault in self.faults:
            silent = fault.kind == "silent" and 0.0 <= self._since(fault.kind) < fault.value
            gone = fault.kind == "gone" and self._sent > fault.value
            if silent or gone:
                self.done[fault.kind] += count
                return True
        return False

    def _tick(self, kind: str) -> bool:
        self.done[kind] += 1
        return True

    def _counted(self, message: can.Message) -> can.Message:
        """Under the counter before, while the node is stuck."""
        frame = messages().decode(message)
        if frame is None or frame.counter is None:
            return message
        identifier = message.arbitration_id
        for fault in self.faults:
            if fault.kind == "stuck" and AFTER_FRAMES < self._sent <= AFTER_FRAMES + fault.value:
                self.done["stuck"] += 1
                return with_counter(message, self._last.get(identifier, frame.counter))
        self._last[identifier] = frame.counter
        return message
