"""The chain's signals in the units of the hardware, as built: millitesla, microvolts, codes, words and frames.

This is the paper's Fig. 2 as a view of :mod:`twin.chain`: the same run, with every signal between the stages. What a
twin leaves ideal shows as such: without a word length there are no codes.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from twin.adc.adc_quantisation import ADC_QUANTISATION, codes_of
from twin.angles import Array
from twin.catalogue import STAGES, output_grid
from twin.chain import Chain, Step
from twin.cordic.bit_true import Codes
from twin.effect import BoolArray
from twin.hall.spinning_current import spin
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
    parts, in_plane = chain.parts, chain.nominal_mT
    vertical = parts.gain * in_plane * behind(steps, "concentrator")
    spun = parts.gain * in_plane * behind(steps, "hall")
    channels = next(step.before for step in steps if step.key == "after channels")
    measured = steps[-1].after[0]
    bits = word_bits(chain)
    words = angle_words(measured, bits)
    spi = spi_frames(words, bits)
    can = can_frames(CAN_IDENTIFIER, spi)
    data, whole = can_data(can)
    received, sound, _ = spi_words(data, bits)
    plates = zip(vertical, parts.plates, strict=True)
    sensitivity = np.array([[plate.sensitivity_uV_per_mT] for plate in parts.plates])
    return Run(
        in_plane_mT=in_plane * behind(steps, "magnet"),
        vertical_mT=vertical,
        unspun_mT=np.stack([spin(field, plate, temp_c=motion.temperature_c).unspun_mT for field, plate in plates]),
        spun_mT=spun,
        voltage_uV=sensitivity * spun,
        amplitude=channels,
        codes=_codes(chain, channels),
        computed_rad=next(step.after for step in steps if step.key == "after channels")[0],
        words=words,
        bits=bits,
        spi=spi,
        can=can,
        received_rad=word_angles(received, bits),
        sound=sound & whole,
    )


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
    """Length of the angle word on the link; the frame's longest where the twin states none or more."""
    grid = output_grid(chain.effects)
    stated = 0 if grid is None else int(chain.values.get(grid.name, grid.null()).get("bits", 0))
    return stated if 0 < stated <= SPI_WORD_BITS else SPI_WORD_BITS


def _codes(chain: Chain, channels: Array) -> Codes | None:
    bits = int(chain.values.get(ADC_QUANTISATION.name, {}).get("bits", 0))
    return codes_of(channels, bits) if bits > 0 else None
