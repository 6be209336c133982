"""A CORDIC in integers, with few iterations and few guard bits."""

from __future__ import annotations

import numpy as np

from ..baseline import Setting
from ..channel_causes import Channels
from ..motion import Array
from .device import Mechanism
from .kind import Planned

CHANNEL_BITS = 12


def integer_cordic(channels: Channels, *, iterations: int, guard: int) -> Array:
    """Vectoring in two's complement, shifts that round down, angles in a table of integers; degrees.

    Channels come as 12-bit integers and are carried with `guard` bits more; so are the angles of 16 bits.
    """
    scale = 2.0 ** (CHANNEL_BITS - 2 + guard)
    x, y = (np.round(one * scale).astype(np.int64) for one in channels)
    folded = x < 0
    x, y = np.where(folded, -x, x), np.where(folded, -y, y)
    unit = 2 ** (16 + guard) / (2 * np.pi)
    angle = np.where(folded, 2 ** (15 + guard), 0)
    for shift in range(iterations):
        part = round(float(np.arctan(2.0**-shift)) * unit)
        up = y >= 0
        x, y = np.where(up, x + (y >> shift), x - (y >> shift)), np.where(up, y - (x >> shift), y + (x >> shift))
        angle = angle + np.where(up, part, -part)
    return np.degrees(angle / unit)


def guarded(rng: np.random.Generator, setting: Setting) -> Planned:
    """6 to 9 iterations with 2 to 6 guard bits."""
    iterations, guard = int(rng.integers(6, 10)), int(rng.integers(2, 7))
    return Planned(
        Mechanism(compute=lambda channels: integer_cordic(channels, iterations=iterations, guard=guard)),
        float(np.degrees(np.sqrt(2.0 / 3.0) * 2.0 ** (1 - iterations))),
        {"cordic_truncation": {"iterations": float(iterations)}},
    )


def long_enough(rng: np.random.Generator, setting: Setting) -> Planned:
    """12 to 14 iterations with 4 to 6 guard bits: what is left is below the noise."""
    iterations, guard = int(rng.integers(12, 15)), int(rng.integers(4, 7))
    return Planned(Mechanism(compute=lambda channels: integer_cordic(channels, iterations=iterations, guard=guard)))
