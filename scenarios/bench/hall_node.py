"""The virtual Hall encoder: the whole twin behind an SPI-like link, and the micro-controller that answers for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from diagnosis.correction.compensation import Correction
from scenarios.bench.faults import FaultyBus
from scenarios.bench.loading import RECEIVING, Loader
from scenarios.bench.messages import CHANNEL_LIMIT, Frame
from scenarios.bench.node import Node
from scenarios.bench.world import World
from twin.angles import TAU, Array
from twin.catalogue import find, output_grid
from twin.chain import Chain
from twin.errors import UserError
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


def word_bits(chain: Chain) -> int:
    """Length of the sensor's angle word: what the twin says, else the link's."""
    grid = output_grid(chain.effects)
    bits = 0 if grid is None else int(float(chain.values.get(grid.name, {}).get(grid.roles("level")[0], 0)))
    return bits if 0 < bits <= SPI_WORD_BITS else SPI_WORD_BITS


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

    def handlers(self) -> Mapping[str, Callable[[Frame], None]]:
        return {"Sync": self._read, "CorrectionPart": self._load}

    def _read(self, frame: Frame) -> None:
        sequence = frame.values["Sequence"]
        measured, channels = self._sensor(self._world.latch(int(sequence)))
        word, fault = self._over_spi(measured)
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

    def _sensor(self, pose: int) -> tuple[float, Array]:
        """The twin's angle [rad] and channels (2,) at a pose."""
        motion, block = self._world.motion(pose)
        channels = measured = np.zeros((1, len(motion)))
        for step in self._chain.steps(motion, np.random.default_rng((*self._seed, 2, block))):
            if step.key == "after channels":
                channels = step.before
            measured = step.after
        return float(measured[0, pose]), channels[:, pose]

    def _over_spi(self, measured_rad: float) -> tuple[int, bool]:
        """The angle word as the micro-controller has it, left aligned to 16 bits; whether the frame was faulty."""
        frame = spi_frame(measured_rad, self._bits, self._read_out)
        self._read_out += 1
        if self._spi_rng.random() < self._spi_faults:
            self.bus.done["spi"] += 1
            frame = frame.copy()
            frame[0, self._spi_rng.integers(frame.shape[1])] ^= 1 << self._spi_rng.integers(8)
        words, sound, _ = spi_words(frame, self._bits)
        return int(words[0]) << (SPI_WORD_BITS - self._bits), not bool(sound[0])

    def _load(self, frame: Frame) -> None:
        values = frame.values
        state = self._loader.take(int(values["Transfer"]), int(values["Item"]), float(values["Value"]))
        if state >= RECEIVING:
            self.say("CorrectionStatus", Transfer=values["Transfer"], Item=values["Item"], State=state)


def spi_frame(measured_rad: float, bits: int, count: int) -> Bytes:
    """The frame (1, 4) of one reading under its rolling count."""
    word = angle_words(np.array([measured_rad]), bits)
    turn_over = 1 << COUNT_BITS
    frames = spi_frames(np.repeat(word, turn_over), bits)
    return frames[count % turn_over :][:1]


def corrected_word(correction: Correction, word: int) -> int:
    """A left-aligned word after the correction."""
    shaft = correction.shaft(word_angles(np.array([word]), SPI_WORD_BITS)) % TAU
    return int(angle_words(shaft, SPI_WORD_BITS)[0])
