"""What a training sweep holds: causes, their strengths and parameters, drawn for many sweeps at once.

Each sweep brings one row of uniform numbers, so that what is drawn for it depends on its own stream alone. Strengths
are in degrees of angle error, about its amplitude. How a cause is drawn at a strength is its own affair:
:func:`twin.drawing.drawn`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.baseline import FACTORS
from twin.catalogue import CATALOGUE, find, unnamed
from twin.chain import Chain
from twin.drawing import drawn, log_span
from twin.effect import BoolArray, Effect
from twin.hall.noise import NOISE
from twin.motion import Motion

CAUSE_UNIFORMS = 4
"""Uniform numbers for a cause's parameters: see :data:`twin.effect.Drawing`."""
BASELINE_UNIFORMS = len(FACTORS)
_SPLIT = (0.8, 0.9)
"""Shares of a million sweeps below which a sweep is for training, then for validation; the rest is for testing."""
Drawn = dict[str, dict[str, Array]]


@dataclass(frozen=True, kw_only=True)
class Ranges:
    """What is drawn from: strengths and noise [deg] log-uniform, up to ``most`` causes a sweep."""

    strength_deg: tuple[float, float] = (0.02, 0.3)
    noise_deg: tuple[float, float] = (0.003, 0.05)
    most: int = 3


@dataclass(frozen=True, eq=False)
class Draw:
    """Parameters of ``batch`` sweeps by effect, each (batch,); which causes act (batch, causes) and how strongly."""

    values: Drawn
    labels: BoolArray
    strength_deg: Array
    noise_deg: Array
    split: Array


def uniforms_needed(causes: tuple[str, ...]) -> int:
    """Length of a sweep's row of uniform numbers."""
    return 3 + BASELINE_UNIFORMS + len(causes) * (2 + CAUSE_UNIFORMS)


def drawable(motion: Motion, effects: Sequence[Effect] = CATALOGUE) -> tuple[str, ...]:
    """Causes among these effects that this motion can show, by name, in chain order."""
    provided = motion.provides
    return tuple(
        effect.name
        for effect in effects
        if not effect.baseline and not unnamed(effect.name) and effect.visible_in(provided)
    )


def draw(uniforms: Array, base: Chain, causes: tuple[str, ...], motion: Motion, ranges: Ranges) -> Draw:
    """Turn rows of uniform numbers (batch, :func:`uniforms_needed`) into sweeps around a twin."""
    batch, count = len(uniforms), len(causes)
    head, rest = uniforms[:, : 3 + BASELINE_UNIFORMS], uniforms[:, 3 + BASELINE_UNIFORMS :]
    noise = log_span(head[:, 0], *ranges.noise_deg)
    how_many = np.floor(head[:, 1] * (min(ranges.most, count) + 1))
    order, strength_u = rest[:, :count], rest[:, count : 2 * count]
    labels = np.argsort(np.argsort(order, axis=1), axis=1) < how_many[:, None]
    strength = np.where(labels, log_span(strength_u, *ranges.strength_deg), 0.0)
    values = baseline_values(head[:, 3:], base)
    values[NOISE.name] = {"rms_deg": noise}
    own = rest[:, 2 * count :].reshape(batch, count, CAUSE_UNIFORMS)
    for column, name in enumerate(causes):
        rows = labels[:, column]
        effect = find(name, base.effects)
        kept = {**effect.null(), **base.values.get(name, {})}
        alike = [key for key in kept if effect.params[key].role != "per turn"]
        params = {key: np.full(batch, kept[key], dtype=np.float64) for key in alike}
        for key, value in drawn(effect, strength[rows, column], own[rows, column], motion).items():
            params[key][rows] = value
        values[name] = params
    return Draw(values, labels, strength, noise, np.searchsorted(_SPLIT, head[:, 2], side="right").astype(np.float64))


def stripped(twin: Chain, causes: tuple[str, ...]) -> Chain:
    """The twin without causes of its own, so that a label says all; its words and iterations stay as they are."""
    return twin.without(*(name for name in causes if find(name, twin.effects).footprint != "values"))


def baseline_values(uniforms: Array, base: Chain) -> Drawn:
    """The paper's error factors (batch,) around the twin's, as devices differ, from uniform numbers (batch, 6)."""
    out: Drawn = {}
    for column, factor in enumerate(FACTORS):
        centre = float(base.values.get(factor.key, {}).get(factor.param, factor.null))
        half = factor.effect.params[factor.param].scatter
        out.setdefault(factor.key, {})[factor.param] = centre + half * (2.0 * uniforms[:, column] - 1.0)
    return out
