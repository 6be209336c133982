"""The chain's signals in the units of the hardware, as built: millitesla, microvolts, codes, words and frames.

This is the paper's Fig. 2 as a view of :mod:`twin.chain`: the same run, with every signal between the stages. What a
twin leaves ideal shows as such: without a word length there are no codes.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from twin.adc.adc_quantisation import ADC_QUANTISATION, codes_of, range_of
from twin.angles import Array
from twin.catalogue import STAGES, output_grid
from twin.chain import Chain, Step
from twin.cordic.bit_true import Codes
from twin.effect import BoolArray
from twin.hall.plates import expected_mT
from twin.link.frames import (
    SPI_WORD_BITS,
    Bits,
    Bytes,
    angle_words,
    can_data,
    can_frames,
    spi_frames,
    spi_words,
    word_angles,
)
from twin.motion import Motion
from twin.parts import Parts

CAN_IDENTIFIER = 0x123


@dataclass(frozen=True, eq=False)
class Run:
    """Every signal of one run; channels are (2, n), words and readings (n,).

    ``unspun_mT`` is what the plates would give with their bias left in one phase. ``codes`` is None where the twin
    states no word length of the converter.
    """

    in_plane_mT: Array
    vertical_mT: Array
    unspun_mT: Array
    spun_mT: Array
    voltage_uV: Array
    amplitude: Array
    codes: Codes | None
    computed_rad: Array
    words: Codes
    bits: int
    spi: Bytes
    can: Bits
    received_rad: Array
    sound: BoolArray


def run(chain: Chain, motion: Motion, rng: np.random.Generator | None = None) -> Run:
    """Run the chain as built over a motion.

    Parameters
    ----------
    chain : Chain
        One sensor.
    motion : Motion
        Conditions of n readings.
    rng : numpy.random.Generator, optional
        Of everything random; without it nothing random acts, and integers are continuous.

    Returns
    -------
    Run
        Readings are those of :meth:`twin.chain.Chain.simulate` with the same generator.
    """
    steps = list(chain.steps(motion, rng))
    in_plane, vertical, voltage = (
        in_units(chain.parts, chain.nominal_mT, stage, behind(steps, stage)) for stage in INSIDE
    )
    computed = next(step for step in steps if step.key == "after channels")
    plates = chain.parts.plates
    measured = steps[-1].after[0]
    bits = word_bits(chain)
    words = angle_words(measured, bits)
    spi = spi_frames(words, bits)
    can = can_frames(CAN_IDENTIFIER, spi)
    data, whole = can_data(can)
    received, sound, _ = spi_words(data, bits)
    unspun = [
        expected_mT(field, replace(plate, spun=False), motion.temperature_c)
        for field, plate in zip(vertical, plates, strict=True)
    ]
    return Run(
        in_plane_mT=in_plane,
        vertical_mT=vertical,
        unspun_mT=np.stack(unspun),
        spun_mT=voltage / sensitivity_uV_per_mT(chain.parts),
        voltage_uV=voltage,
        amplitude=computed.before,
        codes=_codes(chain, computed.before),
        computed_rad=computed.after[0],
        words=words,
        bits=bits,
        spi=spi,
        can=can,
        received_rad=word_angles(received, bits),
        sound=sound & whole,
    )


INSIDE = ("magnet", "concentrator", "hall")
"""Stages behind which the channels have a unit of their own: millitesla in the plane and under the disk, microvolts."""


def in_units(parts: Parts, nominal_mT: float, stage: str, channels: Array) -> Array:
    """Channels of nominal amplitude 1 behind one of :data:`INSIDE`, in that stage's unit."""
    in_plane_mT = nominal_mT * channels
    if stage == "magnet":
        return in_plane_mT
    # Behind the disk the nominal amplitude 1 stands for the vertical field under it.
    vertical_mT = parts.gain * in_plane_mT
    return vertical_mT if stage == "concentrator" else sensitivity_uV_per_mT(parts) * vertical_mT


def sensitivity_uV_per_mT(parts: Parts) -> Array:
    """Of the plates of x and y (2, 1)."""
    return np.array([[plate.sensitivity_uV_per_mT] for plate in parts.plates])


def behind(steps: Iterable[Step], stage: str) -> Array:
    """The channels (2, n) behind the last operation of a stage and of those ahead of it."""
    last = STAGES.index(stage)
    signal: Array | None = None
    for step in steps:
        if step.key == "after field" or (
            signal is not None
            and step.effect is not None
            and step.effect.acts_on == "channels"
            and STAGES.index(step.effect.stage) <= last
        ):
            signal = step.after
    assert signal is not None
    return signal


def word_bits(chain: Chain) -> int:
    """Length of the angle word on the link: the frame's longest where the twin states none, more, or no whole one.

    Steps of a decimal are no word's: they are rounded once more, to the finest word that there is.
    """
    grid = output_grid(chain.effects)
    stated = 0.0 if grid is None else float(chain.values.get(grid.name, {}).get(grid.roles("level")[0], 0.0))
    return int(stated) if 0.0 < stated <= SPI_WORD_BITS and stated.is_integer() else SPI_WORD_BITS


def _codes(chain: Chain, channels: Array) -> Codes | None:
    converter = chain.parts.converter
    if converter is not None:
        return np.asarray(np.round(channels / converter.step), dtype=np.int64)
    stated = chain.values.get(ADC_QUANTISATION.name, {})
    bits = int(stated.get("bits", 0))
    return codes_of(channels, bits, range_of(stated)) if bits > 0 else None
