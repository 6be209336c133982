"""A spin: the shaft coasts or turns evenly, and the Hall encoder alone is read, at its own pace, out of its memory."""

from __future__ import annotations

import contextlib
import itertools
from collections import Counter
from collections.abc import Iterator, Mapping
from collections.abc import Sequence as Several
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from scenarios.bench.bus_log import check_log_name
from scenarios.bench.faults import Opener
from scenarios.bench.hall_node import TAKEN, TAKING
from scenarios.bench.link import Link
from scenarios.bench.messages import HALL_CLOCK_S, SPEED_STEP_RPM
from scenarios.bench.nodes import LET_GO, MOVING, TURNING
from scenarios.bench.readings import Collector
from scenarios.bench.sequence import NodeGone, Patience, Sequence
from scenarios.commands.coast import READINGS_A_TURN
from scenarios.commands.outputs import OutputFiles
from twin.errors import UserError
from twin.limits import require_within
from twin.pace import STOP_AND_MEASURE_S
from twin.spin import FEWEST_ROWS
from twin.sweep_file import csv_text

FASTEST_RPM = 1e4
MOST_OF_A_LEG = (1 << 16) - 1
"""Readings that a CaptureCommand can ask for."""


@dataclass(frozen=True)
class Captured:
    """One row of the log: time [s], angle [deg], channels [nominal amplitudes]."""

    time_s: float
    measured_deg: float
    vx: float | None
    vy: float | None


@dataclass(eq=False)
class SpinAssembler(Collector[Captured]):
    """Readings of the Hall encoder alone."""

    request = "CaptureRead"
    parts = ("HallAngle", "HallTime", "HallChannels")
    clock_s = HALL_CLOCK_S

    def wanted(self) -> tuple[str, ...]:
        return ("HallAngle", "HallTime")

    def reading(self, parts: dict[str, Mapping[str, float]]) -> Captured:
        channels = parts.get("HallChannels") if self.channels else None
        return Captured(
            time_s=self.unwrapped(parts["HallTime"]["Time"]),
            measured_deg=parts["HallAngle"]["Angle"],
            vx=None if channels is None else channels["Vx"],
            vy=None if channels is None else channels["Vy"],
        )


@dataclass(frozen=True, kw_only=True)
class SpinPlan:
    """A coast from each speed, or turning evenly at it: ``time_s`` of each, ``rate_Hz`` readings a second."""

    coast: bool
    speeds_rpm: Several[float] = (600.0,)
    both_directions: bool = False
    time_s: float = 8.0
    rate_Hz: float = 1000.0
    acceleration_rpm_per_s: float = 600.0

    def __post_init__(self) -> None:
        require_within("speed-rpm", list(self.speeds_rpm), SPEED_STEP_RPM, FASTEST_RPM, "rpm")
        require_within("spin-time", self.time_s, 0.01, 1e5, "s")
        require_within("rate", self.rate_Hz, 1.0 / STOP_AND_MEASURE_S, 1e5, "Hz")
        for speed in self.speeds_rpm:
            if speed % SPEED_STEP_RPM:
                raise UserError(f"speed {speed:g} rpm: the drive's command counts in steps of {SPEED_STEP_RPM:g} rpm")
        least = READINGS_A_TURN * max(self.speeds_rpm) / 60.0
        if self.rate_Hz < least:
            raise UserError(
                f"rate is {self.rate_Hz:g} Hz; expected at least {least:g} Hz, {READINGS_A_TURN} readings a turn at "
                f"{max(self.speeds_rpm):g} rpm"
            )
        require_within("readings of a leg (spin-time times rate)", self.count, FEWEST_ROWS, MOST_OF_A_LEG)

    @property
    def count(self) -> int:
        """Readings of a leg."""
        return round(self.time_s * self.rate_Hz)

    def legs(self) -> Iterator[float]:
        """The speed [rpm] of each leg, negative backwards."""
        ways = (1.0, -1.0) if self.both_directions else (1.0,)
        for speed, way in itertools.product(self.speeds_rpm, ways):
            yield way * speed


@dataclass(frozen=True, kw_only=True)
class SpinJob:
    """What to measure and where to put it: ``files`` are all that the run may write, the output among them."""

    plan: SpinPlan
    output: Path
    files: OutputFiles
    channels: bool = True
    patience: Patience = field(default_factory=Patience)
    record: Path | None = None


@dataclass(frozen=True)
class Spun:
    """How many readings there are, how many were asked for where that is known, and what happened on the bus."""

    readings: int
    counts: Counter[str]
    asked: int | None = None


def measure_spin(job: SpinJob, open_bus: Opener) -> Spun:
    """Spin the shaft, read the encoder and write the log. Raises UserError where a node is gone.

    A spin that broke off begins anew: nobody knows how the shaft would have gone on.
    """
    if job.record is not None:
        check_log_name(job.record)
    assembler = SpinAssembler(channels=job.channels)
    try:
        with contextlib.closing(Link(open_bus, assembler, job.record, replace=job.files.force)) as link:
            _take(job.plan, Sequence(link, assembler, job.patience))
    except NodeGone as error:
        raise UserError(f"{error}; mend it, and run again: a spin begins anew") from None
    job.files.write({job.output: spin_text(assembler.readings)})
    return Spun(len(assembler.readings), assembler.counts, job.plan.count * len(list(job.plan.legs())))


def spin_text(readings: Several[Captured]) -> str:
    """The text of a log: the columns that every reading has."""
    columns = {name: [getattr(one, name) for one in readings] for name in ("time_s", "measured_deg", "vx", "vy")}
    return csv_text({name: np.array(values) for name, values in columns.items() if None not in values})


def _take(plan: SpinPlan, sequence: Sequence) -> None:
    """Each leg: bring the shaft to its speed, have the readings taken, read them out; at the end stop the shaft."""
    settings = {"Settle": 0, "Acceleration": round(plan.acceleration_rpm_per_s)}
    sequence.ask("MotionSettings", "MotionStatus", settings, lambda frame: True)
    # Of a run before this one there may be a leg of the same number.
    _capture(sequence, period_us=0, count=0, leg=0)
    legs = list(plan.legs())
    for number, speed in enumerate(legs):
        _drive(sequence, speed, let_go=plan.coast, leg=number)
        _capture(sequence, period_us=round(1e6 / plan.rate_Hz), count=plan.count, leg=number)
        for index in range(plan.count):
            _read_out(sequence, index, leg=number)
    _drive(sequence, 0.0, let_go=False, leg=len(legs))


def _drive(sequence: Sequence, speed_rpm: float, *, let_go: bool, leg: int) -> None:
    done = LET_GO if let_go else TURNING
    values = {"Speed": speed_rpm, "Release": let_go, **_of_leg(leg)}
    _ask_until(sequence, "SpinCommand", "MotionStatus", values, done=done, busy=MOVING)


def _capture(sequence: Sequence, *, period_us: int, count: int, leg: int) -> None:
    values = {"Period": period_us, "Count": count, **_of_leg(leg)}
    _ask_until(sequence, "CaptureCommand", "CaptureStatus", values, done=TAKEN, busy=TAKING)


def _ask_until(
    sequence: Sequence, command: str, status: str, values: Mapping[str, float], *, done: int, busy: int
) -> None:
    """Send a command and wait until its node says that it is done, as long as it says that it is busy."""
    sequence.ask(
        command,
        status,
        values,
        lambda frame: frame.values["State"] == done,
        busy=lambda frame: frame.values["State"] == busy,
    )


def _of_leg(leg: int) -> dict[str, float]:
    """The number of a leg as a message holds it, in one byte."""
    return {"Leg": leg % 256}


def _read_out(sequence: Sequence, index: int, *, leg: int) -> None:
    """One reading; of one whose SPI frame was faulty when it was taken there is no other."""
    found = sequence.assembler
    before = len(found.readings), found.counts["fault flag"]
    sequence.request_reading(
        {"Index": index, **_of_leg(leg)},
        lambda: (len(found.readings), found.counts["fault flag"]) != before,
    )
