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
    """The ending of a log and its bytes, with one to thirty places changed."""
    ending = str(rng.choice(FORMATS))
    raw = bytearray(recorded()[ending])
    for _ in range(int(rng.integers(1, 30))):
        place, change = int(rng.integers(0, len(raw) + 1)), rng.random()
        if change < 0.5:
            raw[place : place + 1] = bytes([int(rng.integers(0, 256))])
        elif change < 0.7:
            raw[place : place + int(rng.integers(1, 40))] = b""
        elif change < 0.9:
            raw[place:place] = rng.choice([b"\n", b"0", b"F" * 20, b"-1 ", b"\x00" * 8, b"9" * 30, b"nan "])
        else:
            start = int(rng.integers(0, len(raw) + 1))
            raw[place:place] = raw[start : start + int(rng.integers(1, 400))]
    if rng.random() < 0.1:
        raw = raw[: int(rng.integers(0, len(raw) + 1))]
    return ending, bytes(raw)
