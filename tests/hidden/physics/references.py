"""What a real reference encoder adds: eccentric discs, sine interpolation, lost counts, a re-made index."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..baseline import Setting
from ..motion import Array, Motion
from .device import Mechanism
from .kind import Planned

Added = Callable[[Motion, np.random.Generator], Array]


def seen_by_head(shaft_deg: Array, shift: float, towards_deg: float, head_deg: float) -> Array:
    """What a head reads more than the shaft turns: its disc's centre off the shaft by a share of the track's radius.

    The line under a fixed head is that in the direction from the disc's centre to the head.
    """
    angle = np.radians(shaft_deg)
    centre = shift * np.exp(1j * (angle + np.radians(towards_deg)))
    head = np.exp(1j * np.radians(head_deg))
    return np.degrees(-np.angle((head - centre) / head))


def _eccentric(rng: np.random.Generator, heads: tuple[float, ...], shift: float) -> Planned:
    towards = float(rng.uniform(0.0, 360.0))

    def reference(motion: Motion, one: np.random.Generator) -> Array:
        return np.mean([seen_by_head(motion.shaft_deg, shift, towards, head) for head in heads], axis=0)

    turn = np.arange(360.0)
    mean = np.mean([seen_by_head(turn, shift, towards, head) for head in heads], axis=0)
    amplitude = float(2 * np.abs(np.mean(mean * np.exp(-1j * np.radians(turn)))))
    return Planned(Mechanism(reference=reference), amplitude, {"reference_eccentricity": {"amplitude_deg": amplitude}})


def eccentric_disc(rng: np.random.Generator, setting: Setting) -> Planned:
    """One head on an eccentric disc."""
    return _eccentric(rng, (0.0,), float(np.radians(rng.uniform(0.1, 0.3))))


def two_heads(rng: np.random.Generator, setting: Setting) -> Planned:
    """Two heads whose mean is read, not quite opposite each other: some of the eccentricity is left."""
    apart = 180.0 + float(rng.choice((-1, 1)) * rng.uniform(25.0, 50.0))
    return _eccentric(rng, (0.0, apart), float(np.radians(rng.uniform(0.5, 0.8))))


def opposite_heads(rng: np.random.Generator, setting: Setting) -> Planned:
    """Two heads opposite each other take the eccentricity out, to its square."""
    return _eccentric(rng, (0.0, 180.0), float(np.radians(rng.uniform(0.1, 0.3))))


def sine_interpolation(rng: np.random.Generator, setting: Setting) -> Planned:
    """Sine and cosine of 32 to 50 lines a turn with offset and gain errors, interpolated: once and twice a line."""
    lines = int(rng.choice((32, 36, 40, 45, 50)))
    offset, phase = float(np.radians(rng.uniform(4.0, 7.0))), float(rng.uniform(0.0, 2 * np.pi))
    gain = 1.0 + offset * float(rng.uniform(0.3, 0.8))

    def reference(motion: Motion, one: np.random.Generator) -> Array:
        within = lines * np.radians(motion.shaft_deg) + phase
        read = np.arctan2(gain * np.sin(within), np.cos(within) + offset)
        return np.degrees(np.angle(np.exp(1j * (read - within)))) / lines

    amplitude = float(np.degrees(offset)) / lines
    return Planned(Mechanism(reference=reference), amplitude, {"drive_ripple": {"order": float(lines)}})


def _lost(rng: np.random.Generator, times: int) -> Planned:
    """At each of some instants well apart the count jumps."""
    steps = rng.choice((-1, 1), times) * rng.uniform(0.1, 0.35, times)

    def reference(motion: Motion, one: np.random.Generator) -> Array:
        rows = len(motion.time_s)
        share = (np.arange(times) + one.uniform(0.25, 0.75, times)) / times
        jumps = np.zeros(rows)
        for row, step in zip((share * rows).astype(int), steps, strict=True):
            jumps[row:] += step
        return jumps

    return Planned(Mechanism(reference=reference), float(np.max(np.abs(steps))))


def lost_once(rng: np.random.Generator, setting: Setting) -> Planned:
    """The counter loses counts once."""
    return _lost(rng, 1)


def lost_several(rng: np.random.Generator, setting: Setting) -> Planned:
    """The counter loses counts three to five times."""
    return _lost(rng, int(rng.integers(3, 6)))


def index_made_anew(rng: np.random.Generator, setting: Setting) -> Planned:
    """Each turn the zero is set anew by a switch that repeats to some hundredths of a degree."""
    spread = float(rng.uniform(0.08, 0.2))

    def reference(motion: Motion, one: np.random.Generator) -> Array:
        return spread * one.standard_normal(motion.turns)[motion.turn]

    return Planned(Mechanism(reference=reference), spread)
