"""The virtual Hall encoder: the whole twin behind an SPI-like link, and the micro-controller that answers for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.correction.compensation import Correction
from scenarios.bench.faults import FaultyBus
from scenarios.bench.loading import RECEIVING, Loader
from scenarios.bench.messages import CHANNEL_LIMIT, HALL_CLOCK_S, Frame
from scenarios.bench.node import Node
from scenarios.bench.world import World
from twin.angles import TAU, Array
from twin.catalogue import find
from twin.chain import Chain
from twin.errors import UserError
from twin.hardware import word_bits
from twin.link.frames import COUNT_BITS, SPI_WORD_BITS, Bytes, angle_words, spi_frames, spi_words, word_angles


def check_playable(chain: Chain) -> None:
    """Raise UserError for a twin whose readings depend on the length of the record."""
    for key, values in chain.values.items():
        effect = find(key, chain.effects)
        if any(one.record_wide and one.acts({**one.null(), **values}) for one in effect.operations):
            raise UserError(
                f"{key}: is defined over a whole record, which a node on the bus does not know; "
                "leave it out of the twin (faults of the bus: --fault)"
            )


TAKING, TAKEN = 1, 2
"""CaptureStatus.State."""


@dataclass(frozen=True, eq=False)
class Memory:
    """The readings of a leg: left-aligned words, whether their SPI frames were faulty, channels (2, n), times [s]."""

    leg: float
    words: Sequence[int]
    faulty: Sequence[bool]
    channels: Array
    time_s: Array


class HallNode(Node):
    """Latches the twin's reading, carries it over SPI, corrects it where a correction is loaded, and sends it."""

    def __init__(
        self, bus: FaultyBus, world: World, chain: Chain, seed: tuple[int, ...], *, spi_faults: float = 0.0
    ) -> None:
        """``spi_faults``: share of SPI frames with a bit flipped on the way."""
        super().__init__("hall", bus)
        self._world, self._chain, self._seed = world, chain, seed
        self._bits = word_bits(chain)
        self._read_out = 0
        self._spi_faults, self._spi_rng = spi_faults, np.random.default_rng((*seed, 5))
        self._loader = Loader()
        self._memory: Memory | None = None

    def handlers(self) -> Mapping[str, Callable[[Frame], None]]:
        return {
            "Sync": self._read,
            "CorrectionPart": self._load,
            "CaptureCommand": self._capture,
            "CaptureRead": self._read_memory,
        }

    def _read(self, frame: Frame) -> None:
        sequence = frame.values["Sequence"]
        pose = self._world.latch(int(sequence))
        measured, channels = self._sensor(slice(pose, pose + 1))
        words, faulty = self._over_spi(measured)
        self._say_reading(sequence, words[0], fault=faulty[0], channels=channels[:, 0])

    def _capture(self, frame: Frame) -> None:
        values = frame.values

        def say(state: int) -> None:
            self.say("CaptureStatus", Sequence=values["Sequence"], Leg=values["Leg"], State=state)

        if not values["Count"]:
            self._memory = None
        elif self._memory is None or self._memory.leg != values["Leg"]:
            say(TAKING)
            poses = self._world.capture(1e-6 * values["Period"], int(values["Count"]), busy=lambda: say(TAKING))
            measured, channels = self._sensor(poses)
            time_s = self._world.motion(poses.stop - 1)[0].time_s[poses]
            self._memory = Memory(values["Leg"], *self._over_spi(measured), channels, time_s)
        say(TAKEN)

    def _read_memory(self, frame: Frame) -> None:
        sequence, index, memory = frame.values["Sequence"], int(frame.values["Index"]), self._memory
        if memory is None or memory.leg != frame.values["Leg"] or index >= memory.time_s.size:
            return
        self.say("HallTime", Sequence=sequence, Time=float(memory.time_s[index]) % HALL_CLOCK_S)
        self._say_reading(sequence, memory.words[index], fault=memory.faulty[index], channels=memory.channels[:, index])

    def _say_reading(self, sequence: float, word: int, *, fault: bool, channels: Array) -> None:
        correction = self._loader.active
        if correction is not None:
            word = corrected_word(correction, word)
        self.say(
            "HallAngle",
            Sequence=sequence,
            Angle=word * (360.0 / (1 << SPI_WORD_BITS)),
            Bits=self._bits,
            Corrected=correction is not None,
            SpiFault=fault,
        )
        if correction is None:
            vx, vy = np.clip(channels, -CHANNEL_LIMIT, CHANNEL_LIMIT)
            self.say("HallChannels", Sequence=sequence, Vx=float(vx), Vy=float(vy))

    def _sensor(self, poses: slice) -> tuple[Array, Array]:
        """The twin's angles [rad] (n,) and channels (2, n) at some poses."""
        motion, block = self._world.motion(poses.stop - 1)
        channels = measured = np.zeros((1, len(motion)))
        for step in self._chain.steps(motion, np.random.default_rng((*self._seed, 2, block))):
            if step.key == "after channels":
                channels = step.before
            measured = step.after
        return measured[0, poses], channels[:, poses]

    def _over_spi(self, measured_rad: Array) -> tuple[list[int], list[bool]]:
        """The words (n,) as the micro-controller has them, left aligned to 16 bits; which frames were faulty."""
        frames = spi_frame(measured_rad, self._bits, self._read_out)
        self._read_out += measured_rad.size
        for frame in frames:
            if self._spi_rng.random() < self._spi_faults:
                self.bus.done["spi"] += 1
                frame[self._spi_rng.integers(frame.size)] ^= 1 << self._spi_rng.integers(8)
        words, sound, _ = spi_words(frames, self._bits)
        return (words << (SPI_WORD_BITS - self._bits)).tolist(), (~sound).tolist()

    def _load(self, frame: Frame) -> None:
        values = frame.values
        state = self._loader.take(int(values["Transfer"]), int(values["Item"]), float(values["Value"]))
        if state >= RECEIVING:
            self.say("CorrectionStatus", Transfer=values["Transfer"], Item=values["Item"], State=state)


def spi_frame(measured_rad: Array, bits: int, count: int) -> Bytes:
    """The frames (n, 4) of readings (n,), the first of them under its rolling count."""
    before = count % (1 << COUNT_BITS)
    words = angle_words(np.concatenate([np.zeros(before), measured_rad]), bits)
    return spi_frames(words, bits)[before:]


def corrected_word(correction: Correction, word: int) -> int:
    """A left-aligned word after the correction."""
    shaft = correction.shaft(word_angles(np.array([word]), SPI_WORD_BITS)) % TAU
    return int(angle_words(shaft, SPI_WORD_BITS)[0])
