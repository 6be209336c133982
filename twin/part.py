"""A described part as an operation on the chain's signals: it has no parameter to fit, its description is its value."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from twin.angles import Array
from twin.effect import ActsOn, Effect, Forward, Parameters
from twin.motion import Motion

SEEN_IN_MIRROR = np.array([[1.0], [-1.0]])
"""What a mirror along the x axis does to the channels."""


def part(
    name: str, stage: str, forward: Forward, source: str, *, noisy: bool = False, acts_on: ActsOn = "channels"
) -> Effect:
    """A part that acts on the channels (..., 2, n) of nominal amplitude 1, ahead of the effects of its stage.

    Or on the shaft's angle at which each is sampled.
    """
    return Effect(
        name=name,
        stage=stage,
        acts_on=acts_on,
        params={},
        forward=forward,
        source=source,
        signature="as described",
        footprint="spread" if noisy else "mean",
    )


def in_mirror(given: Effect) -> Effect:
    """The part in a chain that counts the other way on both sides and reads the same; the shaft turns as it did."""
    if given.acts_on == "shaft":
        return given

    def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        return SEEN_IN_MIRROR * given.forward(SEEN_IN_MIRROR * signal, motion, values, rng)

    return replace(given, forward=forward)


def per_design(value: Any) -> Array:
    """A number, or one for each design (designs,), as it multiplies signals (..., 2, n)."""
    array = np.asarray(value, dtype=np.float64)
    return array[:, None, None] if array.ndim == 1 else array
