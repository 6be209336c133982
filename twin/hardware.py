"""The paper's Fig. 2 end to end, in the units of the hardware: magnet, disk, spun plates, converter, CORDIC, SPI, CAN.

The chain of effects (:mod:`twin.chain`) is what fits and searches run on; this is what its parameters come from.
Each reading is one cycle of the spinning current. Pure functions of the description, the motion and a generator.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from twin.adc.converter import Codes, Converter, convert, instants
from twin.angles import Array
from twin.concentrator.disk import Disk
from twin.cordic.bit_true import Cordic, vectoring, wrapped
from twin.effect import BoolArray
from twin.hall.spinning_current import Plate, Spinning, spin
from twin.limits import OutOfRangeError, require_within
from twin.link.frames import Bits, Bytes, can_data, can_frames, spi_frames, spi_words, word_angles
from twin.magnet.assembly import Assembly
from twin.motion import Motion

CAN_IDENTIFIER = 0x123


@dataclass(frozen=True, kw_only=True, eq=False)
class Hardware:
    """One part on one shaft. Plates of x and y may differ; the converter's full scale counts in nominal amplitudes."""

    assembly: Assembly = field(default_factory=Assembly)
    disk: Disk = field(default_factory=Disk)
    plates: tuple[Plate, Plate] = field(default_factory=lambda: (Plate(), Plate()))
    converter: Converter = field(default_factory=Converter)
    cordic: Cordic = field(default_factory=Cordic)
    angle_bits: int = 14

    def __post_init__(self) -> None:
        require_within("angle_bits", self.angle_bits, 1, 16, "bit", whole=True)
        if self.cordic.word_bits < self.converter.bits:
            raise OutOfRangeError(
                f"word_bits of the CORDIC is {self.cordic.word_bits} bit; "
                f"expected at least the converter's {self.converter.bits} bit"
            )
        if self.cordic.angle_bits < self.angle_bits:
            raise OutOfRangeError(
                f"angle_bits of the CORDIC is {self.cordic.angle_bits} bit; expected at least {self.angle_bits} bit"
            )


@dataclass(frozen=True, eq=False)
class Run:
    """Every signal of one run; channels are (2, n), words and readings (n,)."""

    at_s: Array
    in_plane_mT: Array
    vertical_mT: Array
    spun: tuple[Spinning, Spinning]
    amplitude: Array
    codes: Codes
    cordic_words: Codes
    words: Codes
    spi: Bytes
    can: Bits
    received_rad: Array
    sound: BoolArray


def run(hardware: Hardware, motion: Motion, rng: np.random.Generator | None = None) -> Run:
    """Run the part over a motion; without a generator nothing random acts."""
    converter, disk = hardware.converter, hardware.disk
    # A reading is paired with the reference when it is ready: it was sampled a latency before.
    at = instants(motion.time_s - converter.latency_s, converter, rng)
    angle = motion.shaft_rad + motion.speed_rad_s * (at - motion.time_s)
    nominal = hardware.assembly.nominal_mT
    # The disk mixes both components, so each channel needs the whole field at its own instant.
    both = [nominal * hardware.assembly.channels(np.stack([one, one]), motion) for one in angle]
    in_plane = np.stack([both[0][0], both[1][1]])
    vertical = np.stack([_flux(row @ plane, disk) for row, plane in zip(disk.conversion, both, strict=True)])
    spun = (spin(vertical[0], hardware.plates[0], rng), spin(vertical[1], hardware.plates[1], rng))
    amplitude = np.stack([one.output_mT for one in spun]) / (disk.gain * nominal)
    codes = convert(amplitude, at, converter, rng)
    turned, _ = vectoring(codes[0], codes[1], hardware.cordic)
    words = _rounded(turned, hardware.cordic.angle_bits, hardware.angle_bits)
    spi = spi_frames(words, hardware.angle_bits)
    can = can_frames(CAN_IDENTIFIER, spi)
    data, whole = can_data(can)
    received, sound, _ = spi_words(data, hardware.angle_bits)
    return Run(
        at_s=at,
        in_plane_mT=in_plane,
        vertical_mT=vertical,
        spun=spun,
        amplitude=amplitude,
        codes=codes,
        cordic_words=turned,
        words=words,
        spi=spi,
        can=can,
        received_rad=word_angles(received, hardware.angle_bits),
        sound=sound & whole,
    )


def _flux(vertical_mT: Array, disk: Disk) -> Array:
    """The vertical field [mT] under a disk that saturates along a tanh curve."""
    level = disk.gain * disk.saturation_mT
    return np.asarray(level * np.tanh(vertical_mT / level))


def _rounded(words: Codes, from_bits: int, to_bits: int) -> Codes:
    """Signed angle words rounded to fewer bits, as words in [0, 2^to_bits)."""
    drop = from_bits - to_bits
    nearest = (words + (1 << drop >> 1)) >> drop
    return wrapped(nearest, to_bits) & ((1 << to_bits) - 1)
