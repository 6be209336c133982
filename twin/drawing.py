"""Parameters of training sweeps from uniform numbers in [0, 1): by declaration alone, and pieces for a ``drawing``."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import TAU, Array, radians
from twin.effect import Effect, Param
from twin.motion import Motion

YARDSTICK_DEG = 0.1
"""Angle error that a parameter of its typical size makes, about its amplitude."""


def drawn(effect: Effect, strength_deg: Array, uniform: Array, motion: Motion) -> dict[str, Array]:
    """Parameters (k,) of an effect at strengths [deg] (k,), from uniform numbers (k, 4): see its ``drawing``."""
    declared = by_declaration(effect, strength_deg, uniform, motion)
    return declared if effect.drawing is None else {**declared, **effect.drawing(strength_deg, uniform, motion)}


def by_declaration(effect: Effect, strength_deg: Array, uniform: Array, motion: Motion) -> dict[str, Array]:
    """The parameters that an effect is drawn with where it has no ``drawing``.

    A strength, level or size of noise is drawn in units of its typical size, with either sign where physics allows
    both; several strengths share the size as components of a vector. Phases are uniform over the turn, and shapes are
    among those that a search tries.
    """
    found = _shapes(effect, uniform[:, 2], motion)
    size = strength_deg / YARDSTICK_DEG
    names = effect.roles("strength")
    for name, share in zip(names, _shares(uniform[:, 0], len(names)), strict=True):
        found[name] = _acting(effect.params[name], size, share)
    for name in (*effect.roles("level"), *effect.roles("random")):
        found.setdefault(name, _acting(effect.params[name], size, np.ones(size.size)))
    found |= dict.fromkeys(effect.roles("phase"), 360.0 * uniform[:, 1])
    return found


def _acting(param: Param, size: Array, share: Array) -> Array:
    """A value so many typical sizes away from null, on a side that physics allows."""
    lowest, highest = param.allowed or (param.lower, param.upper)
    if lowest == param.null:
        share = np.abs(share)
    elif highest == param.null:
        share = -np.abs(share)
    value = param.null + size * param.typical * share
    return np.asarray(np.clip(np.round(value) if param.counts else value, lowest, highest))


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
    found = {name: np.array([shape[name] for shape in grid])[rows] for name in (grid[0] if grid else ())}
    if effect.line is not None and effect.params[effect.line.param].role == "shape":
        lines = effect.line.some(motion)
        if not lines.size:
            return found
        found[effect.line.param] = lines[whole(uniform, 0, lines.size - 1).astype(np.int64)]
    return found


def span(uniform: Array, low: float, high: float) -> Array:
    """Uniform between low and high."""
    return np.asarray(low + (high - low) * uniform)


def log_span(uniform: Array, low: float, high: float) -> Array:
    """Uniform in the logarithm, between low and high."""
    return np.asarray(low * (high / low) ** uniform)


def whole(uniform: Array, low: int, high: int) -> Array:
    """Whole numbers from low to high, both included."""
    return np.asarray(np.minimum(np.floor(low + (high - low + 1) * uniform), high))


def delay(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """The delay in which the fastest shaft turns by the strength, of either sign."""
    fastest = float(np.max(np.abs(motion.speed_rad_s)))
    return {"delay_us": 1e6 * radians(strength_deg) / fastest * np.where(uniform[:, 0] < 0.5, -1.0, 1.0)}
