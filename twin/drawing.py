"""Parameters of training sweeps from uniform numbers in [0, 1): by declaration alone, and pieces for a ``drawing``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from twin.angles import TAU, Array, radians
from twin.motion import Motion

if TYPE_CHECKING:
    from twin.effect import Effect, Param

YARDSTICK_DEG = 0.1
"""Angle error that a parameter of its typical size makes, about its amplitude."""


def by_declaration(effect: Effect, strength_deg: Array, uniform: Array, motion: Motion) -> dict[str, Array]:
    """Parameters (k,) of an effect at strengths [deg] (k,), from uniform numbers (k, 4).

    What acts goes by its yardstick, of either sign where physics allows both; several strengths share it as a vector
    does. Phases are even over the turn, shapes one of those that a search tries.
    """
    drawn = _shapes(effect, uniform[:, 2], motion)
    size = strength_deg / YARDSTICK_DEG
    names = effect.roles("strength")
    for name, share in zip(names, _shares(uniform[:, 0], len(names)), strict=True):
        drawn[name] = _acting(effect.params[name], size, share)
    for name in (*effect.roles("level"), *effect.roles("random")):
        drawn.setdefault(name, _acting(effect.params[name], size, np.ones(size.size)))
    drawn |= dict.fromkeys(effect.roles("phase"), 360.0 * uniform[:, 1])
    return drawn


def _acting(param: Param, size: Array, share: Array) -> Array:
    """So many times the typical size from null, in a direction that physics allows."""
    lowest, highest = param.allowed or (param.lower, param.upper)
    if lowest == param.null:
        share = np.abs(share)
    elif highest == param.null:
        share = -np.abs(share)
    return np.asarray(np.clip(param.null + size * param.typical * share, lowest, highest))


def _shares(uniform: Array, count: int) -> tuple[Array, ...]:
    if count == 1:
        return (np.where(uniform < 0.5, -1.0, 1.0),)
    if count == 2:
        return np.cos(TAU * uniform), np.sin(TAU * uniform)
    # Of unit length on average, and any two of them uncorrelated.
    return tuple(np.sqrt(2.0 / count) * np.cos(TAU * uniform * (1 + place)) for place in range(count))


def _shapes(effect: Effect, uniform: Array, motion: Motion) -> dict[str, Array]:
    """Shapes, and levels that are tried with them: one row of the grid, one line of those that a spectrum looks at."""
    grid = [shape for shape in effect.shapes(motion) if shape]
    rows = whole(uniform, 0, len(grid) - 1).astype(np.int64)
    drawn = {name: np.array([shape[name] for shape in grid])[rows] for name in (grid[0] if grid else ())}
    if effect.line is not None and effect.params[effect.line.param].role == "shape":
        lines = effect.line.some(motion)
        if not lines.size:
            return drawn
        drawn[effect.line.param] = lines[whole(uniform, 0, lines.size - 1).astype(np.int64)]
    return drawn


def span(uniform: Array, low: float, high: float) -> Array:
    """Even from low to high."""
    return np.asarray(low + (high - low) * uniform)


def log_span(uniform: Array, low: float, high: float) -> Array:
    """Even in the logarithm, from low to high."""
    return np.asarray(low * (high / low) ** uniform)


def whole(uniform: Array, low: int, high: int) -> Array:
    """Whole numbers from low to high, both included."""
    return np.asarray(np.minimum(np.floor(low + (high - low + 1) * uniform), high))


def delay(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """The delay in which the fastest shaft turns by the strength, of either sign."""
    fastest = float(np.max(np.abs(motion.speed_rad_s)))
    return {"delay_us": 1e6 * radians(strength_deg) / fastest * np.where(uniform[:, 0] < 0.5, -1.0, 1.0)}
