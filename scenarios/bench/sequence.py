"""The sequence: drive to an angle, let it settle, ask all nodes for what they read, repeat."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from diagnosis.correction.compensation import Correction
from scenarios.bench.link import Link
from scenarios.bench.loading import ACTIVE, RECEIVING, items, numbers
from scenarios.bench.messages import Frame, messages
from scenarios.bench.nodes import AT_REST, MOVING, PASSED
from scenarios.bench.plan import Plan, Stop, resolution_deg
from scenarios.bench.readings import REFUSED, Collector, Event, Reading
from twin.errors import UserError

NODE_WORDS = {
    "Stepper": "the stepper's controller",
    "Reference": "the reference encoder",
    "Hall": "the Hall encoder",
    "Chamber": "the climate chamber",
}


class NodeGone(UserError):
    """A node did not answer in all attempts; the message says which one and what it was asked for."""


@dataclass(frozen=True, kw_only=True)
class Patience:
    """How long to wait for an answer [s], how often to ask a silent node, and how long a busy one may be busy [s]."""

    timeout_s: float = 0.2
    attempts: int = 15
    longest_s: float = 7200.0


@dataclass(eq=False)
class Sequence:
    """Runs a plan over a link."""

    link: Link
    assembler: Collector[Any]
    patience: Patience

    def prepare(self, plan: Plan, first: Stop) -> None:
        """Settings of the drive, and the run-in before the first reading."""
        settings = {"Settle": round(plan.settle_s * 1000.0), "Acceleration": round(plan.acceleration_rpm_per_s)}
        self.ask("MotionSettings", "MotionStatus", settings, lambda frame: True)
        for angle in plan.run_in_deg(first):
            self.drive(angle, plan.drive_rpm)

    def take(self, plan: Plan, stops: Iterable[Stop], keep: Callable[[Reading], None]) -> None:
        """Take the readings one after the other; ``keep`` gets each as soon as it is complete."""
        temperature: float | None = None
        for stop in stops:
            if stop.temperature_c is not None and stop.temperature_c != temperature:
                temperature = stop.temperature_c
                self._heat(temperature)
            if stop.speed_rpm:
                self.drive(stop.angle_deg, stop.speed_rpm, passing=True)
            else:
                self.drive(stop.angle_deg, plan.drive_rpm)
            keep(self._read(stop))

    def drive(self, angle_deg: float, speed_rpm: float, *, passing: bool = False) -> None:
        """Go to an angle and stand still, or pass it at this speed."""
        done = PASSED if passing else AT_REST
        self.ask(
            "MotionCommand",
            "MotionStatus",
            {"Target": resolution_deg(angle_deg), "Speed": speed_rpm, "Passing": passing},
            lambda frame: frame.values["State"] == done,
            busy=lambda frame: frame.values["State"] == MOVING,
        )

    def load(self, correction: Correction | None) -> None:
        """Load a correction into the Hall encoder, or take it out again."""
        transfer = self.link.next_sequence() % 256
        listed = items(numbers(correction))
        for item, value in enumerate(listed):
            wanted = ACTIVE if item == len(listed) - 1 else RECEIVING
            given = {"Transfer": transfer, "Item": item}
            answer = self.ask("CorrectionPart", "CorrectionStatus", {**given, "Value": value}, _matches(given))
            if answer.values["State"] != wanted:
                raise UserError(f"the Hall encoder refused the correction at item {item} of {len(listed)}")

    def _heat(self, temperature_c: float) -> None:
        self.ask(
            "TemperatureCommand",
            "ChamberStatus",
            {"Setpoint": temperature_c},
            lambda frame: bool(frame.values["Reached"]),
            busy=lambda frame: not frame.values["Reached"],
        )

    def _read(self, stop: Stop) -> Reading:
        """One reading; a frame that is missing or not to be trusted is asked for again, together with the others."""
        label = {
            "Index": stop.index,
            "Turn": stop.turn,
            "Backwards": stop.direction < 0,
            "Speed": stop.speed_rpm,
        }
        before = len(self.assembler.readings)
        self.request_reading(label, lambda: len(self.assembler.readings) > before)
        reading: Reading = self.assembler.readings[-1]
        return reading

    def request_reading(self, label: Mapping[str, float], answered: Callable[[], bool]) -> None:
        """Ask all nodes for a reading until it is ``answered``."""
        name, refused = self.assembler.request, self.assembler.counts.copy()
        for attempt in range(self.patience.attempts):
            if attempt:
                self._repeat(name, attempt)
            self.link.send(name, {"Sequence": self.link.next_sequence(), **label})
            end = time.monotonic() + self.patience.timeout_s
            while (left := end - time.monotonic()) > 0.0:
                self.link.receive(left)
                if answered():
                    return
        raise self._gone({messages().sender(part) for part in self.assembler.missing}, name, refused)

    def ask(
        self,
        name: str,
        answer: str,
        values: Mapping[str, float],
        done: Callable[[Frame], bool],
        *,
        busy: Callable[[Frame], bool] = lambda frame: False,
    ) -> Frame:
        """Send a request until its answer comes. A node that says it is busy is asked on, a silent one is given up."""
        numbered = name != "CorrectionPart"
        asked: set[float] = set()
        silent, refused = 0, self.assembler.counts.copy()
        give_up = time.monotonic() + self.patience.longest_s
        while silent < self.patience.attempts and time.monotonic() < give_up:
            if silent:
                self._repeat(name, silent)
            silent += 1
            sequence = self.link.next_sequence()
            asked.add(sequence)
            self.link.send(name, {**values, **({"Sequence": sequence} if numbered else {})})
            end = time.monotonic() + self.patience.timeout_s
            while (left := end - time.monotonic()) > 0.0:
                frame = self.link.receive(left)
                if frame is None or frame.name != answer or (numbered and frame.values["Sequence"] not in asked):
                    continue
                if done(frame):
                    return frame
                if busy(frame):
                    silent = 0
        raise self._gone({messages().sender(answer)}, name, refused)

    def _repeat(self, name: str, attempt: int) -> None:
        self.assembler.counts["asked again"] += 1
        self.assembler.on_event(Event(f"attempt {attempt + 1}", name, None))

    def _gone(self, nodes: set[str], name: str, before: Counter[str]) -> NodeGone:
        waited = self.patience.attempts * self.patience.timeout_s
        said = " and ".join(NODE_WORDS[node] for node in sorted(nodes))
        refused = ", ".join(f"{n} x {kind}" for kind, n in (self.assembler.counts - before).items() if kind in REFUSED)
        how = f"gave no answer that can be trusted ({refused})" if refused else "did not answer"
        return NodeGone(f"{said} {how}: {name}, {self.patience.attempts} attempts, {waited:g} s")


def _matches(given: dict[str, int]) -> Callable[[Frame], bool]:
    return lambda frame: all(frame.values[key] == value for key, value in given.items())
