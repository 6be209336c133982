"""The virtual nodes that drive and watch the shaft: stepper controller, reference encoder, climate chamber."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from scenarios.bench.faults import FaultyBus
from scenarios.bench.messages import REFERENCE_CLOCK_S, Frame
from scenarios.bench.node import Node
from scenarios.bench.stepper import Stepper
from scenarios.bench.world import World
from twin.angles import TAU
from twin.chain import Chain
from twin.motion import RPM
from twin.reference.encoder import Encoder

MOVING, AT_REST, PASSED, TURNING, LET_GO = 1, 2, 3, 4, 5
"""MotionStatus.State."""
CHAMBER_TIME_CONSTANT_S = 300.0
CHAMBER_BAND_C = 0.05
"""A chamber's pace and what counts as reached: typical assumptions."""


class StepperNode(Node):
    """Drives to targets and past them; counts its steps, not where the shaft really stands."""

    def __init__(self, bus: FaultyBus, world: World, drive: Stepper) -> None:
        super().__init__("stepper", bus)
        self._world, self._drive = world, drive
        self._commanded_rad = 0.0
        self._done: tuple[float, float, float] | None = None
        self._leg: float | None = None
        self._spun = False

    def handlers(self) -> Mapping[str, Callable[[Frame], None]]:
        return {"MotionCommand": self._move, "MotionSettings": self._set, "SpinCommand": self._spin}

    def _set(self, frame: Frame) -> None:
        self._drive = replace(
            self._drive,
            settle_s=frame.values["Settle"] / 1000.0,
            acceleration_rpm_per_s=frame.values["Acceleration"],
        )
        # Whoever sets the drive up counts legs of their own.
        self._leg = None
        self._report(frame, 0)

    def _spin(self, frame: Frame) -> None:
        values = frame.values

        def busy() -> None:
            self._report(frame, MOVING)

        if values["Leg"] != self._leg:
            busy()
            speed = values["Speed"] * RPM
            duration = abs(speed - self._world.speed_rad_s) / (self._drive.acceleration_rpm_per_s * RPM)
            self._world.spin_up(speed, duration, let_go=bool(values["Release"]), busy=busy)
            self._leg, self._spun = values["Leg"], True
        self._report(frame, LET_GO if values["Release"] else TURNING)

    def _move(self, frame: Frame) -> None:
        values = frame.values
        if self._spun:
            # Of a shaft that has spun, the drive begins to count its steps anew where it stands.
            self._commanded_rad, self._done, self._spun = self._drive.commanded(self._world.shaft_rad), None, False
        order = (values["Target"], values["Speed"], values["Passing"])
        if order != self._done:
            self._report(frame, MOVING)
            self._drive_to(frame, float(np.radians(values["Target"])))
            self._done = order
        self._report(frame, PASSED if values["Passing"] else AT_REST)

    def _drive_to(self, frame: Frame, target_rad: float) -> None:
        speed_rpm = frame.values["Speed"]
        commanded = self._drive.commanded(target_rad)
        distance = commanded - self._commanded_rad
        self._commanded_rad = commanded
        if not distance:
            return

        def busy() -> None:
            self._report(frame, MOVING)

        if frame.values["Passing"]:
            # At speed the rotor runs through its detents: their error averages out, and there is no settling.
            speed = float(np.sign(distance)) * speed_rpm * RPM
            ramp_s = self._drive.ramp_s(speed_rpm) if self._world.speed_rad_s == 0.0 else 0.0
            self._world.turn_to(commanded, distance / speed + ramp_s, speed, busy=busy)
        else:
            duration = self._drive.duration(distance, speed_rpm)
            self._world.turn_to(self._drive.stands(commanded), duration, busy=busy)

    def _report(self, frame: Frame, state: int) -> None:
        position = float(np.degrees(self._commanded_rad))
        self.say("MotionStatus", Sequence=frame.values["Sequence"], Position=position, State=state)


class ReferenceNode(Node):
    """An incremental encoder: lines, interpolation, an index that has to be passed once; the twin's effects on it."""

    def __init__(self, bus: FaultyBus, world: World, chain: Chain, encoder: Encoder, seed: tuple[int, ...]) -> None:
        super().__init__("reference", bus)
        self._world, self._chain, self._encoder, self._seed = world, chain, encoder, seed

    def handlers(self) -> Mapping[str, Callable[[Frame], None]]:
        return {"Sync": self._read}

    def _read(self, frame: Frame) -> None:
        sequence = frame.values["Sequence"]
        pose = self._world.latch(int(sequence))
        motion, block = self._world.motion(pose)
        reading = self._chain.reference(motion, np.random.default_rng((*self._seed, 1, block)))[: pose + 1]
        low, high = (edge - np.radians(self._encoder.index_deg) for edge in self._world.swept(pose))
        seen = self._encoder.has_index and bool(np.floor(high / TAU) > np.floor(low / TAU))
        counted = replace(self._encoder, has_index=seen).read(reading)[pose]
        self.say("ReferenceAngle", Sequence=sequence, Angle=np.degrees(counted) % 360.0, IndexSeen=seen, Fault=0)
        self.say("ReferenceTime", Sequence=sequence, Time=self._world.at(pose)["time_s"] % REFERENCE_CLOCK_S)


class ChamberNode(Node):
    """Follows its setpoint as a first-order lag and says when it is there."""

    def __init__(self, bus: FaultyBus, world: World) -> None:
        super().__init__("chamber", bus)
        self._world = world
        self._setpoint_c = world.temperature_c

    def handlers(self) -> Mapping[str, Callable[[Frame], None]]:
        return {"Sync": self._read, "TemperatureCommand": self._heat}

    def _heat(self, frame: Frame) -> None:
        self._setpoint_c = frame.values["Setpoint"]
        away = self._setpoint_c - self._world.temperature_c
        if abs(away) > CHAMBER_BAND_C:

            def busy() -> None:
                self._say(frame, self._world.temperature_c)

            duration = CHAMBER_TIME_CONSTANT_S * float(np.log(abs(away) / CHAMBER_BAND_C))
            self._world.heat_to(self._setpoint_c - float(np.sign(away)) * CHAMBER_BAND_C, duration, busy=busy)
        self._say(frame, self._world.temperature_c)

    def _read(self, frame: Frame) -> None:
        self._say(frame, self._world.at(self._world.latch(int(frame.values["Sequence"])))["temperature_c"])

    def _say(self, frame: Frame, temperature_c: float) -> None:
        reached = abs(temperature_c - self._setpoint_c) <= CHAMBER_BAND_C + 0.005
        self.say(
            "ChamberStatus",
            Sequence=frame.values["Sequence"],
            Temperature=temperature_c,
            Setpoint=self._setpoint_c,
            Reached=reached,
        )
