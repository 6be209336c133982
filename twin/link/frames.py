"""The angle word on the wire: an SPI-like frame with a checksum, then a CAN frame, and what goes wrong there.

Pure functions over arrays: words (n,), frames (n, bytes) of 8-bit values, bit streams (n, bits) of 0 and 1.
The SPI-like frame is four bytes: the angle word in the upper bits of two, a status byte (rolling count in its lower
half), and CRC-8/SAE-J1850 over the three. The CAN frame is a classic data frame with 11-bit identifier (ISO 11898-1).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from twin.angles import TAU, Array
from twin.effect import BoolArray
from twin.limits import OutOfRangeError, require_within

Words = NDArray[np.int64]
Bytes = NDArray[np.uint8]
Bits = NDArray[np.uint8]

SPI_WORD_BITS = 16
COUNT_BITS = 4
CRC8_POLYNOMIAL, CRC8_START, CRC8_FINAL = 0x1D, 0xFF, 0xFF
CRC15_POLYNOMIAL = 0x4599
CAN_IDENTIFIER_BITS = 11
CAN_LONGEST_DATA = 8
CAN_STUFF_AFTER = 5


# ---- angle word ----------------------------------------------------------------------------------------------------


def angle_words(angle_rad: Array, bits: int) -> Words:
    """Angles [rad] of any shape rounded to words of ``bits`` bits in [0, 2^bits), a turn being 2^bits."""
    require_within("bits", bits, 1, SPI_WORD_BITS, "bit", whole=True)
    return np.asarray(np.round(angle_rad / TAU * 2.0**bits), dtype=np.int64) % (1 << bits)


def word_angles(words: Words, bits: int) -> Array:
    """Words of any shape as angles [rad] in [0, 2 pi)."""
    return np.asarray(words * (TAU / 2.0**bits))


# ---- SPI-like frame ------------------------------------------------------------------------------------------------


def spi_frames(words: Words, bits: int) -> Bytes:
    """Frames (n, 4) of words (n,) of ``bits`` bits, counted from 0 in the order of the array."""
    require_within("word", words, 0, (1 << bits) - 1, whole=True)
    placed = words << (SPI_WORD_BITS - bits)
    count = np.arange(words.size) % (1 << COUNT_BITS)
    body = np.stack([placed >> 8, placed & 0xFF, count], axis=-1).astype(np.uint8)
    return np.concatenate([body, crc8(body)[:, None]], axis=-1)


def spi_words(frames: Bytes, bits: int) -> tuple[Words, BoolArray, BoolArray]:
    """Words (n,) of frames (n, 4); which frames have a right checksum; which are stale.

    A frame is stale where its rolling count has not moved on from the frame before.
    """
    wide = frames.astype(np.int64)
    words = ((wide[:, 0] << 8) | wide[:, 1]) >> (SPI_WORD_BITS - bits)
    sound = crc8(frames[:, :3]) == frames[:, 3]
    count = wide[:, 2] & ((1 << COUNT_BITS) - 1)
    stale = np.concatenate([[False], np.diff(count) == 0])
    return words, sound, stale


def crc8(data: Bytes) -> Bytes:
    """CRC-8/SAE-J1850 (n,) of byte rows (n, k)."""
    register = np.full(data.shape[0], CRC8_START, dtype=np.int64)
    for column in data.T.astype(np.int64):
        register ^= column
        for _ in range(8):
            register = np.where(register & 0x80, (register << 1) ^ CRC8_POLYNOMIAL, register << 1) & 0xFF
    return (register ^ CRC8_FINAL).astype(np.uint8)


# ---- CAN frame -----------------------------------------------------------------------------------------------------


def can_frames(identifier: int, data: Bytes) -> Bits:
    """Bits (n, 34 + 8 k) of classic CAN data frames with data rows (n, k), from start of frame to checksum, unstuffed.

    Start of frame, identifier, RTR = IDE = r0 = 0, length, data, CRC-15.
    """
    require_within("identifier", identifier, 0, (1 << CAN_IDENTIFIER_BITS) - 1, whole=True)
    rows, length = data.shape
    if length > CAN_LONGEST_DATA:
        raise OutOfRangeError(f"length of data is {length} bytes; expected from 0 to {CAN_LONGEST_DATA} bytes")
    head = np.concatenate([[0], _bits_of(identifier, CAN_IDENTIFIER_BITS), [0, 0, 0], _bits_of(length, 4)])
    body = np.concatenate(
        [np.broadcast_to(head.astype(np.uint8), (rows, head.size)), np.unpackbits(data, axis=-1)], axis=-1
    )
    return np.concatenate([body, crc15(body)], axis=-1)


def can_data(frames: Bits) -> tuple[Bytes, BoolArray]:
    """Data rows (n, k) of unstuffed frames, and which have a right checksum."""
    body, check = frames[:, :-15], frames[:, -15:]
    data = np.packbits(body[:, 1 + CAN_IDENTIFIER_BITS + 3 + 4 :], axis=-1)
    return data, np.all(crc15(body) == check, axis=-1)


def crc15(bits: Bits) -> Bits:
    """CRC-15/CAN (n, 15) of bit rows (n, m), most significant bit first."""
    register = np.zeros(bits.shape[0], dtype=np.int64)
    for bit in bits.T:
        carry = (register >> 14) ^ bit
        register = np.where(carry, (register << 1) ^ CRC15_POLYNOMIAL, register << 1) & 0x7FFF
    return ((register[:, None] >> np.arange(14, -1, -1)) & 1).astype(np.uint8)


def stuffed_length(frames: Bits) -> Words:
    """Bits (n,) on the wire after stuffing: a complement follows every five equal bits, stuffed ones counted."""
    lengths = np.full(frames.shape[0], frames.shape[1], dtype=np.int64)
    last = np.full(frames.shape[0], 2, dtype=np.int64)
    run = np.zeros(frames.shape[0], dtype=np.int64)
    for bit in frames.T.astype(np.int64):
        run = np.where(bit == last, run + 1, 1)
        stuff = run == CAN_STUFF_AFTER
        lengths += stuff
        # The stuffed complement starts a run of its own.
        last = np.where(stuff, 1 - bit, bit)
        run = np.where(stuff, 1, run)
    return lengths


# ---- what goes wrong -----------------------------------------------------------------------------------------------


def repeat_stale(frames: Bytes, fraction: float, rng: np.random.Generator) -> Bytes:
    """Frames (n, k) of which this fraction, never the first, are the frame before once more."""
    require_within("fraction", fraction, 0.0, 1.0)
    stale = rng.random(len(frames)) < fraction
    stale[:1] = False
    return frames[np.maximum.accumulate(np.where(stale, 0, np.arange(len(frames))))]


def flip_bits(frames: Bytes, rate: float, rng: np.random.Generator) -> Bytes:
    """Frames (n, k) whose bits each flip with this probability."""
    require_within("rate", rate, 0.0, 1.0)
    flips = rng.random((*frames.shape, 8)) < rate
    return np.asarray(frames ^ np.packbits(flips, axis=-1)[..., 0], dtype=np.uint8)


def _bits_of(value: int, width: int) -> Bits:
    return np.asarray((value >> np.arange(width - 1, -1, -1)) & 1, dtype=np.uint8)
