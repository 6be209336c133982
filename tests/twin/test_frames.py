"""Frames: published check values, round trips, and what checksums catch."""

from __future__ import annotations

import numpy as np
import pytest

from twin.angles import wrap
from twin.limits import OutOfRangeError
from twin.link.frames import (
    angle_words,
    can_data,
    can_frames,
    crc8,
    crc15,
    flip_bits,
    repeat_stale,
    spi_frames,
    spi_words,
    stuffed_length,
    word_angles,
)

CHECK = np.frombuffer(b"123456789", dtype=np.uint8)[None, :]
ANGLES = np.random.default_rng(1).uniform(-10.0, 10.0, 4000)


def test_checksums_give_the_published_check_values() -> None:
    """The catalogue of parametrised CRC algorithms: CRC-8/SAE-J1850 0x4B, CRC-15/CAN 0x059E over "123456789"."""
    assert crc8(CHECK)[0] == 0x4B
    assert int("".join(map(str, crc15(np.unpackbits(CHECK, axis=-1))[0])), 2) == 0x059E


@pytest.mark.parametrize("bits", [8, 12, 14, 16])
def test_words_survive_both_links(bits: int) -> None:
    words = angle_words(ANGLES, bits)
    received, sound, stale = spi_words(spi_frames(words, bits), bits)
    np.testing.assert_array_equal(received, words)
    assert sound.all()
    assert not stale.any()
    data, whole = can_data(can_frames(0x123, spi_frames(words, bits)))
    assert whole.all()
    np.testing.assert_array_equal(data, spi_frames(words, bits))
    assert np.max(np.abs(wrap(word_angles(words, bits) - ANGLES))) <= np.pi / 2**bits * (1 + 1e-9)


def test_every_single_flip_is_caught() -> None:
    frames = spi_frames(angle_words(ANGLES[:20], 14), 14)
    for bit in range(32):
        hit = frames.copy()
        hit[:, bit // 8] ^= np.uint8(1 << bit % 8)
        assert not spi_words(hit, 14)[1].any()
    bits = can_frames(0x7FF, frames)
    for place in range(bits.shape[1]):
        hit = bits.copy()
        hit[:, place] ^= 1
        assert not can_data(hit)[1].any()


def test_flips_come_at_their_rate() -> None:
    frames = spi_frames(angle_words(ANGLES, 14), 14)
    hit = flip_bits(frames, 0.01, np.random.default_rng(2))
    flipped = np.unpackbits(frames ^ hit).mean()
    assert flipped == pytest.approx(0.01, abs=5 * np.sqrt(0.01 * 0.99 / (32 * len(frames))))


def test_stale_frames_are_seen_by_their_count() -> None:
    frames = spi_frames(angle_words(ANGLES, 14), 14)
    late = repeat_stale(frames, 0.1, np.random.default_rng(3))
    repeated = np.concatenate([[False], np.all(late[1:] == late[:-1], axis=-1)])
    np.testing.assert_array_equal(spi_words(late, 14)[2], repeated)
    assert repeated.mean() == pytest.approx(0.1, abs=5 * np.sqrt(0.09 / len(frames)))


def test_stuffing_by_hand() -> None:
    assert stuffed_length(np.array([[0, 0, 0, 0, 0, 1, 1, 1, 1, 1]], dtype=np.uint8))[0] == 12
    # 00000 1 | 1111 reaches five with the stuffed one: 0 0 0 0 0 (1) 1 1 1 1 (0).
    assert stuffed_length(np.array([[0, 0, 0, 0, 0, 1, 1, 1, 1]], dtype=np.uint8))[0] == 11
    assert stuffed_length(np.array([[0, 1] * 8], dtype=np.uint8))[0] == 16


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: angle_words(ANGLES, 0), "bits is 0 bit; expected a whole number from 1 to 16 bit"),
        (lambda: can_frames(4096, CHECK), "identifier is 4096; expected a whole number from 0 to 2047"),
        (lambda: can_frames(1, CHECK), "length of data is 9 bytes; expected from 0 to 8 bytes"),
        (lambda: flip_bits(CHECK, float("nan"), np.random.default_rng(0)), "rate is nan; expected from 0 to 1"),
    ],
)
def test_refuses_by_name_value_and_range(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(OutOfRangeError) as refused:
        call()
    assert str(refused.value) == message
