"""Causes in the digital path: how an angle is computed from the channels, rounded and sent."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .baseline import Injected, Setting
from .channel_causes import Channels
from .motion import Array

Words = npt.NDArray[np.int64]


def plan_cordic_truncation(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """The number of iterations whose error, sqrt(2) times its RMS, is nearest the strength."""

    def left_deg(iterations: int) -> float:
        return float(np.degrees(np.sqrt(2.0 / 3.0) * 2.0 ** (1 - iterations)))

    iterations = min(range(6, 15), key=lambda n: abs(np.log(left_deg(n) / strength)))
    return Injected("cordic_truncation", left_deg(iterations), {"iterations": float(iterations)})


def cordic(channels: Channels, iterations: int) -> Array:
    """Vectoring with shifts 2^0 .. 2^-(iterations - 1); the half-plane x < 0 is folded over. Degrees."""
    folded = channels[0] < 0
    flip = np.where(folded, -1.0, 1.0)
    x, y = channels[0] * flip, channels[1] * flip
    angle = np.where(folded, 180.0, 0.0)
    for shift in range(iterations):
        part = 2.0**-shift
        towards = np.where(y >= 0, 1.0, -1.0)
        x, y = x + towards * y * part, y - towards * x * part
        angle = angle + towards * np.degrees(np.arctan(part))
    return angle


def plan_output_quantisation(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """The number of bits whose rounding error, sqrt(2) times its RMS, is nearest the strength."""

    def left_deg(bits: int) -> float:
        return float(np.sqrt(2.0 / 12.0) * 360.0 / 2**bits)

    bits = min(range(8, 14), key=lambda b: abs(np.log(left_deg(b) / strength)))
    return Injected("output_quantisation", left_deg(bits), {"bits": float(bits), "step_deg": 360.0 / 2**bits})


def to_words(angle_deg: Array, bits: int) -> Words:
    """Nearest word of an angle."""
    nearest: Words = np.mod(np.round(angle_deg * (2**bits / 360.0)), 2**bits).astype(np.int64)
    return nearest


def _apart(rng: np.random.Generator, allowed: Array, count: int) -> Array:
    """Rows out of those allowed, no two within two rows of each other."""
    kept: list[int] = []
    for row in rng.permutation(allowed.astype(np.int64)).tolist():
        if all(abs(row - other) > 2 for other in kept):
            kept.append(row)
        if len(kept) == count:
            break
    return np.array(sorted(kept), dtype=float)


def plan_stale_frames(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """A share of the frames, each where the shaft had moved; strength: sqrt(2) times the RMS."""
    motion = setting.motion
    moved = np.abs(motion.travel_deg) > max(0.3 * 360.0 / motion.points_per_turn, 3 * setting.word_deg)
    rows = len(moved)
    share = float(rng.uniform(0.003, 0.008) if setting.weak else rng.uniform(0.005, 0.03))
    hit = _apart(rng, np.flatnonzero(moved).astype(float), max(4, round(share * rows)))
    jumps = motion.travel_deg[hit.astype(np.int64)]
    return Injected(
        "stale_frames",
        float(np.sqrt(2.0 * np.sum(jumps**2) / rows)),
        {"fraction_percent": 100.0 * len(hit) / rows},
        {"rows": hit, "whole_frame": np.array([float(rng.integers(0, 2))])},
    )


def repeat_frames(values: Array | Words, injected: Injected) -> Array | Words:
    """The rows hit show what the row before showed."""
    sent = values.copy()
    for row in injected.hidden["rows"].astype(np.int64):
        sent[row] = sent[row - 1]
    return sent


def plan_bus_glitch(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Few rows, one bit each, worth 360/2^k degrees with k of 2 to 7."""
    rows = len(setting.motion.time_s)
    share = float(rng.uniform(0.002, 0.004) if setting.weak else rng.uniform(0.003, 0.008))
    count = int(np.clip(round(share * rows), 2, 12))
    hit = _apart(rng, np.arange(1, rows - 1, dtype=float), count)
    power = rng.integers(2, 8, size=len(hit)).astype(float)
    return Injected(
        "bus_glitch",
        float(np.sqrt(2.0 * np.sum((360.0 / 2**power) ** 2) / rows)),
        {"count": float(len(hit))},
        {"rows": hit, "power": power},
    )


def flip_bits(words: Words, bits: int, injected: Injected) -> Words:
    """One bit of each word hit is inverted."""
    sent = words.copy()
    sent[injected.hidden["rows"].astype(np.int64)] ^= 1 << (bits - injected.hidden["power"].astype(np.int64))
    return sent
