"""From frames to readings: what belongs together, and what is not to be trusted.

Nothing here knows whether the frames come from a bus or from a recorded log, so both give the same readings.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Generic, TypeVar

import can

from scenarios.bench.messages import COUNTS, REFERENCE_CLOCK_S, Frame, messages

SENSOR_PARTS = ("ReferenceAngle", "ReferenceTime", "HallAngle")
OPTIONAL_PARTS = ("HallChannels", "ChamberStatus")
REFUSED = ("checksum", "counter stands still", "fault flag")
"""Kinds of events that say of a frame that it cannot be trusted."""
R = TypeVar("R")


@dataclass(frozen=True)
class Reading:
    """One row of the sweep: angles [deg], time [s], speed [rpm, signed], channels [nominal amplitudes]."""

    index: int
    time_s: float
    reference_deg: float
    measured_deg: float
    direction: int
    speed_rpm: float
    turn: int
    temperature_c: float | None
    vx: float | None
    vy: float | None
    index_seen: bool
    corrected: bool


@dataclass(frozen=True)
class Event:
    """Something to keep in the log: what happened, to which message, at which place of the plan."""

    kind: str
    message: str
    index: int | None


@dataclass(eq=False)
class Collector(ABC, Generic[R]):
    """Takes every frame, sent and received, in order; ``readings`` grows by those that are complete.

    ``channels``: a reading is complete only with the two channels, as long as no correction is active.
    """

    request: ClassVar[str]
    """The message that asks for a reading and says which."""
    parts: ClassVar[tuple[str, ...]]
    """The messages that may belong to one."""
    clock_s: ClassVar[float]
    """After this time the clock of the readings begins anew."""
    channels: bool = True
    on_event: Callable[[Event], None] = lambda event: None
    readings: list[R] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    label: dict[str, float] = field(default_factory=dict)
    _parts: dict[str, Frame] = field(default_factory=dict)
    _last: dict[str, tuple[int, bytes]] = field(default_factory=dict)
    _clock_base_s: float = 0.0
    _clock_s: float = 0.0

    @abstractmethod
    def wanted(self) -> tuple[str, ...]:
        """The messages that a reading cannot do without, besides those of the channels."""

    @abstractmethod
    def reading(self, parts: dict[str, Mapping[str, float]]) -> R:
        """The reading of a label and the values of its messages."""

    def feed(self, message: can.Message) -> Frame | None:
        """The frame where it can be trusted, None otherwise."""
        frame = messages().decode(message)
        if frame is None:
            self.counts["foreign"] += 1
            return None
        self.counts["frames"] += 1
        if not frame.sound:
            self._refuse("checksum", frame)
            return None
        if frame.counter is not None and not self._moves_on(frame, bytes(message.data)):
            return None
        if frame.name == self.request:
            self.label, self._parts = dict(frame.values), {}
        elif frame.name in self.parts:
            self._take(frame)
        return frame

    @property
    def missing(self) -> tuple[str, ...]:
        """The messages that the reading asked for last still lacks."""
        angle = self._parts.get("HallAngle")
        corrected = angle is not None and angle.values["Corrected"]
        channels = ("HallChannels",) if self.channels and not corrected else ()
        return tuple(name for name in (*self.wanted(), *channels) if name not in self._parts)

    def _moves_on(self, frame: Frame, data: bytes) -> bool:
        """Whether the rolling counter has gone on; a gap is counted, a repeat is not used."""
        assert frame.counter is not None
        last = self._last.get(frame.name)
        self._last[frame.name] = (frame.counter, data)
        if last is None:
            return True
        step = (frame.counter - last[0]) % COUNTS
        if step == 0:
            self._refuse("duplicated" if data == last[1] else "counter stands still", frame)
            return False
        if step > 1:
            self.counts["missed by counter"] += step - 1
            self.on_event(Event(f"{step - 1} missed before this one", frame.name, self._index))
        return True

    def _take(self, frame: Frame) -> None:
        if frame.values["Sequence"] != self.label.get("Sequence"):
            # Also a chamber's answer to its setpoint: nobody waits for it here.
            if frame.name != "ChamberStatus":
                self._refuse("late", frame)
            return
        if frame.values.get("Fault") or frame.values.get("SpiFault"):
            self._refuse("fault flag", frame)
            return
        if not self.missing:
            return
        self._parts[frame.name] = frame
        if not self.missing:
            self.readings.append(self.reading({name: part.values for name, part in self._parts.items()}))

    def unwrapped(self, clock_s: float) -> float:
        """The node's clock without its turn-overs."""
        if clock_s < self._clock_s - 0.5 * self.clock_s:
            self._clock_base_s += self.clock_s
        self._clock_s = clock_s
        return self._clock_base_s + clock_s

    @property
    def _index(self) -> int | None:
        return int(self.label["Index"]) if self.label else None

    def _refuse(self, kind: str, frame: Frame) -> None:
        self.counts[kind] += 1
        self.on_event(Event(kind, frame.name, self._index))


@dataclass(eq=False)
class Assembler(Collector[Reading]):
    """Readings of both encoders. ``chamber``: one is complete only with the temperature."""

    request = "Sync"
    parts = (*SENSOR_PARTS, *OPTIONAL_PARTS)
    clock_s = REFERENCE_CLOCK_S
    chamber: bool = True

    def wanted(self) -> tuple[str, ...]:
        return (*SENSOR_PARTS, *(("ChamberStatus",) if self.chamber else ()))

    def reading(self, parts: dict[str, Mapping[str, float]]) -> Reading:
        label = self.label
        way = -1 if label["Backwards"] else 1
        seen: dict[str, Any] = {**parts["ReferenceAngle"]}
        channels = parts.get("HallChannels") if self.channels else None
        chamber = parts.get("ChamberStatus") if self.chamber else None
        corrected = bool(parts["HallAngle"]["Corrected"])
        return Reading(
            index=int(label["Index"]),
            time_s=self.unwrapped(parts["ReferenceTime"]["Time"]),
            reference_deg=seen["Angle"],
            measured_deg=parts["HallAngle"]["Angle"],
            direction=way,
            # Not -0.
            speed_rpm=way * label["Speed"] + 0.0,
            turn=int(label["Turn"]),
            temperature_c=None if chamber is None else chamber["Temperature"],
            vx=None if channels is None or corrected else channels["Vx"],
            vy=None if channels is None or corrected else channels["Vy"],
            index_seen=bool(seen["IndexSeen"]),
            corrected=corrected,
        )
