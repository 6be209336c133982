"""Recorded buses broken at random: a virtual bench's log in each format, its bytes and lines changed."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from tests.command_line import halltwin

Generator = np.random.Generator
FORMATS = (".asc", ".blf", ".csv", ".log", ".trc")


@cache
def recorded() -> dict[str, bytes]:
    """A log of twelve readings in each format."""
    logs = {}
    with tempfile.TemporaryDirectory() as folder:
        for ending in FORMATS:
            log = Path(folder) / f"bus{ending}"
            ended = halltwin("bench", "-o", Path(folder) / f"{ending[1:]}.csv", "--points", "12", "--record", log)
            assert ended.code == 0, ended.err
            logs[ending] = log.read_bytes()
    return logs


def mutated(rng: Generator) -> tuple[str, bytes]:
    """The ending of a log and its bytes: frames of it lost, doubled or moved, or one to thirty places changed."""
    ending = str(rng.choice(FORMATS))
    raw = recorded()[ending]
    if ending != ".blf" and rng.random() < 0.7:
        raw = _frames_changed(raw, rng)
    if rng.random() < 0.5:
        raw = _bytes_changed(raw, rng)
    return ending, raw


def _frames_changed(raw: bytes, rng: Generator) -> bytes:
    """Lines, each of which is a frame, lost, doubled, moved, or with another digit."""
    lines = raw.split(b"\n")
    for _ in range(int(rng.integers(1, 20))):
        k, to = (int(place) for place in rng.integers(0, len(lines), 2))
        change = rng.random()
        if change < 0.3:
            del lines[k]
        elif change < 0.5:
            lines.insert(to, lines[k])
        elif change < 0.7:
            lines.insert(min(k + 1, to), lines.pop(k))
        elif lines[k]:
            place = int(rng.integers(0, len(lines[k])))
            lines[k] = lines[k][:place] + bytes(rng.choice(list(b"0123456789ABCDEF"), 1)) + lines[k][place + 1 :]
    return b"\n".join(lines)


def _bytes_changed(raw: bytes, rng: Generator) -> bytes:
    found = bytearray(raw)
    for _ in range(int(rng.integers(1, 30))):
        place, change = int(rng.integers(0, len(found) + 1)), rng.random()
        if change < 0.5:
            found[place : place + 1] = bytes([int(rng.integers(0, 256))])
        elif change < 0.7:
            found[place : place + int(rng.integers(1, 40))] = b""
        elif change < 0.9:
            found[place:place] = rng.choice([b"\n", b"0", b"F" * 20, b"-1 ", b"\x00" * 8, b"9" * 30, b"nan "])
        else:
            start = int(rng.integers(0, len(found) + 1))
            found[place:place] = found[start : start + int(rng.integers(1, 400))]
    return bytes(found[: int(rng.integers(0, len(found) + 1))] if rng.random() < 0.1 else found)
