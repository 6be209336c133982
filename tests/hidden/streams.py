"""Random streams that do not disturb one another.

Each thing that is drawn (motion, baseline, noise, every cause) has a stream of its own, so that
adding a cause to a draw leaves everything else in it as it was.
"""

from __future__ import annotations

import zlib

import numpy as np


def stream(seed: int, *names: str) -> np.random.Generator:
    """Generator that depends on the seed and on what it is for, and on nothing else."""
    return np.random.default_rng([seed, *(zlib.crc32(name.encode()) for name in names)])


def derived_seed(seed: int, *names: str) -> int:
    """A 31-bit seed for one draw of a study, the same on every machine."""
    return zlib.crc32("/".join([str(seed), *names]).encode()) & 0x7FFFFFFF
