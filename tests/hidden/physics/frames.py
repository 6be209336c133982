"""Faults of the link: frames that stay behind in bursts, top bits that flip."""

from __future__ import annotations

import numpy as np

from ..baseline import Setting
from ..motion import Motion
from ..word_causes import Words
from .device import Mechanism
from .kind import Planned


def stale_bursts(rng: np.random.Generator, setting: Setting) -> Planned:
    """A busy controller sends the same frame 2 to 4 times more, now and then."""
    bursts, longest = int(rng.integers(6, 14)), 5

    def words(sent: Words, bits: int, motion: Motion, one: np.random.Generator) -> Words:
        out = sent.copy()
        # one after the other: what is sent again is the frame that was sent last
        for first in np.sort(one.choice(np.arange(2, len(sent) - longest), bursts, replace=False)):
            out[first : first + int(one.integers(2, longest))] = out[first - 1]
        return out

    step = 360.0 / setting.motion.points_per_turn
    return Planned(Mechanism(words=words), float(step * 2 * np.sqrt(3 * bursts / len(setting.motion.time_s))))


def top_bits(rng: np.random.Generator, setting: Setting) -> Planned:
    """The two top bits of single words are inverted."""
    count = int(rng.integers(4, 10))

    def words(sent: Words, bits: int, motion: Motion, one: np.random.Generator) -> Words:
        out = sent.copy()
        rows = 1 + 3 * one.choice((len(sent) - 3) // 3, count, replace=False)
        out[rows] ^= 1 << (bits - one.integers(1, 3, count))
        return out

    return Planned(Mechanism(words=words), 10.0, {"bus_glitch": {"count": float(count)}})
