"""Converters in integers: successive approximation, pipeline, and a reference that a charger shakes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..baseline import Setting
from ..channel_causes import Channels
from ..motion import Array, Motion
from .device import Mechanism
from .kind import Planned

FULL_SCALE = 1.25
"""A channel's largest value, nominal amplitudes."""


def approximate(value: Array, weights: Array, *, stuck: tuple[int, int] | None = None) -> Array:
    """Codes of a successive approximation, offset binary.

    `value` of shape (n,) in steps above the lowest code; `weights` (bits,) of the capacitors in steps, heaviest first.
    A bit stuck at a level stands in the trial and in the result, so the lower bits work against it.
    """
    bits = len(weights)
    held, code = np.zeros_like(value), np.zeros(len(value))
    for place, weight in enumerate(weights):
        worth = 2.0 ** (bits - 1 - place)
        on = value >= held + weight
        if stuck is not None and stuck[0] == place:
            on = np.full(len(value), bool(stuck[1]))
        held, code = held + np.where(on, weight, 0.0), code + np.where(on, worth, 0.0)
    return code


def _sar(bits: int, weights: Array, stuck: tuple[int, int] | None = None) -> Callable[[Channels, Motion], Channels]:
    step = 2 * FULL_SCALE / 2**bits

    def convert(channels: Channels, motion: Motion) -> Channels:
        x, y = ((approximate((one + FULL_SCALE) / step, weights, stuck=stuck) + 0.5) * step for one in channels)
        return x - FULL_SCALE, y - FULL_SCALE

    return convert


def sar_capacitor(rng: np.random.Generator, setting: Setting) -> Planned:
    """One of the heavy capacitors is off by some codes: jumps where its bit turns over."""
    bits, place = 12, int(rng.integers(1, 4))
    weights = 2.0 ** np.arange(bits - 1, -1, -1)
    codes = float(rng.choice((-1, 1)) * rng.uniform(5.0, 12.0))
    weights[place] += codes
    return Planned(Mechanism(convert=_sar(bits, weights)), float(np.degrees(abs(codes) * 2 * FULL_SCALE / 2**bits)))


def stuck_in_sar(rng: np.random.Generator, setting: Setting) -> Planned:
    """A bit is stuck inside the approximation: the lower bits fill up or run empty to make up for it."""
    bits, bit, level = 12, int(rng.integers(2, 5)), int(rng.integers(0, 2))
    weights = 2.0 ** np.arange(bits - 1, -1, -1)
    return Planned(
        Mechanism(convert=_sar(bits, weights, (bits - 1 - bit, level))),
        float(np.degrees(2**bit * 2 * FULL_SCALE / 2**bits)),
        {"adc_stuck_bit": {"level": float(level), "step_percent": 100.0 * 2**bit * 2 * FULL_SCALE / 2**bits}},
    )


def pipelined(value: Array, *, stages: int, first_gain: float) -> Array:
    """A pipeline of 1.5-bit stages on values in -1 .. 1, the first amplifier's gain off its 2."""
    out, residue, gain = np.zeros_like(value), value, first_gain
    for stage in range(1, stages + 1):
        digit = np.where(residue > 0.25, 1.0, np.where(residue < -0.25, -1.0, 0.0))
        out = out + digit * 2.0**-stage
        residue, gain = gain * (residue - 0.5 * digit), 2.0
    return out


def pipeline_gain(rng: np.random.Generator, setting: Setting) -> Planned:
    """The first stage's gain is short: a saw over the three ranges of its digit."""
    short = float(rng.uniform(0.005, 0.015))

    def convert(channels: Channels, motion: Motion) -> Channels:
        x, y = (FULL_SCALE * pipelined(one / FULL_SCALE, stages=14, first_gain=2.0 * (1 - short)) for one in channels)
        return x, y

    return Planned(Mechanism(convert=convert), float(np.degrees(short * FULL_SCALE * 0.25)))


def charger_ripple(rng: np.random.Generator, setting: Setting) -> Planned:
    """A charger's ripple with harmonics on the converter's reference; y is converted a while after x."""
    motion = setting.motion
    top = 0.12 / motion.finest_step_s
    slowest = float(np.min(np.abs(motion.speed_rpm))) / 60.0
    base = float(rng.uniform(0.5, 1.0) * min(top, 60.0))
    base = (np.floor(base / slowest) + rng.uniform(0.35, 0.65)) * slowest
    delay = float(rng.uniform(0.1, 0.25)) / base
    size = np.radians(rng.uniform(0.12, 0.25)) / np.sin(np.pi * base * delay)
    shares, phases = np.array([1.0, rng.uniform(0.2, 0.4), rng.uniform(0.1, 0.2)]), rng.uniform(0.0, 2 * np.pi, 3)

    def ripple(time_s: Array) -> Array:
        return size * sum(
            a * np.cos(2 * np.pi * (n + 1) * base * time_s + p)
            for n, (a, p) in enumerate(zip(shares, phases, strict=True))
        )

    def electric(channels: Channels, moved: Motion) -> Channels:
        return channels[0] / (1 + ripple(moved.time_s)), channels[1] / (1 + ripple(moved.time_s + delay))

    return Planned(Mechanism(electric=electric), 0.15, {"reference_ripple": {"frequency_Hz": base}})
