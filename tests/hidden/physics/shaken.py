"""Noise as it comes: white, sluggish, ringing, with heavy tails, and hum with harmonics."""

from __future__ import annotations

import numpy as np

from ..baseline import Setting
from ..channel_causes import Channels
from ..motion import Array, Motion
from .device import Mechanism
from .kind import Planned


def white(rng: np.random.Generator, setting: Setting) -> Planned:
    """Nothing but white noise."""
    return Planned(Mechanism())


def autoregressive(white_noise: Array, first: float, second: float = 0.0) -> Array:
    """Two-term autoregression of white noise, its scatter made 1."""
    out = np.zeros(len(white_noise) + 2)
    for row, shock in enumerate(white_noise):
        out[row + 2] = first * out[row + 1] + second * out[row] + shock
    # (1 + b) / ((1 - b) ((1 + b)^2 - a^2)) with the sign of b turned
    variance = (1 - second) / ((1 + second) * ((1 - second) ** 2 - first**2))
    return out[2:] / np.sqrt(variance)


def sluggish(rng: np.random.Generator, setting: Setting) -> Planned:
    """An amplifier slower than the readings: noise correlated from one to the next."""
    share = float(rng.uniform(0.4, 0.85))

    def noise(one: np.random.Generator, motion: Motion) -> Array:
        return autoregressive(one.standard_normal(len(motion.time_s) + 100), share)[100:]

    return Planned(Mechanism(noise=noise))


def ringing_bracket(rng: np.random.Generator, setting: Setting) -> Planned:
    """A bracket rings at its resonance under random knocks: a narrow band of noise."""
    quality, place = float(rng.uniform(5.0, 20.0)), float(rng.uniform(0.08, 0.35))
    radius = np.exp(-np.pi * place / quality)
    first, second = 2 * radius * np.cos(2 * np.pi * place), -(radius**2)

    def noise(one: np.random.Generator, motion: Motion) -> Array:
        rows = len(motion.time_s)
        ring = autoregressive(one.standard_normal(rows + 400), first, second)[400:]
        return 0.8 * ring + 0.6 * one.standard_normal(rows)

    return Planned(Mechanism(noise=noise))


def heavy_tails(rng: np.random.Generator, setting: Setting) -> Planned:
    """Knocks of all sizes: Student's t with four to six degrees of freedom."""
    freedom = float(rng.uniform(4.0, 6.0))
    scale = np.sqrt((freedom - 2) / freedom)
    return Planned(Mechanism(noise=lambda one, motion: scale * one.standard_t(freedom, len(motion.time_s))))


def hum(rng: np.random.Generator, setting: Setting) -> Planned:
    """Mains and its third and fifth harmonic on both channels, folded where the readings are too slow for them."""
    mains = float(rng.choice((50.0, 60.0)) * rng.uniform(0.998, 1.002))
    size = np.radians(rng.uniform(0.15, 0.35)) * np.array([1.0, rng.uniform(0.1, 0.3), rng.uniform(0.05, 0.15)])
    phases, share = rng.uniform(0.0, 2 * np.pi, 3), float(rng.uniform(0.0, 2 * np.pi))

    def electric(channels: Channels, motion: Motion) -> Channels:
        turn = 2 * np.pi * mains * motion.time_s
        wave = sum(a * np.cos(n * turn + p) for n, a, p in zip((1, 3, 5), size, phases, strict=True))
        return channels[0] + np.cos(share) * wave, channels[1] + np.sin(share) * wave

    return Planned(Mechanism(electric=electric), float(np.degrees(size[0])), {"mains_pickup": {"frequency_Hz": mains}})


def knocked(rng: np.random.Generator, setting: Setting) -> Planned:
    """For a tenth of the record a machine nearby shakes the bench: four times the noise."""
    first, length = float(rng.uniform(0.1, 0.8)), float(rng.uniform(0.08, 0.15))

    def noise(one: np.random.Generator, motion: Motion) -> Array:
        rows = len(motion.time_s)
        place = np.arange(rows) / rows
        return one.standard_normal(rows) * np.where((place > first) & (place < first + length), 4.0, 1.0)

    return Planned(Mechanism(noise=noise))
