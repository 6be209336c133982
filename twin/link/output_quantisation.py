"""output_quantisation: the angle word has b bits; the 3600 steps of one decimal of a degree are 11.81 bits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import TAU, Array
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion

_WHOLE = 1e-12
"""Share of a number of steps that is the rounding of its logarithm."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    bits = np.asarray(values["bits"], dtype=np.float64)
    count = 2.0**bits
    step = TAU / count
    # Few decimals of a radian: a turn is no whole number of steps, and each is counted from its own zero.
    turns = np.where(_is_whole(count), 0.0, np.floor(signal / TAU) * TAU)
    return np.where(bits > 0, np.round((signal - turns) / step) * step + turns, signal)


def _is_whole(count: Array | float) -> Array:
    return np.asarray(np.abs(count - np.round(count)) < _WHOLE * count)


def attainable(values: Parameters) -> Array:
    """All angles [rad] of a turn: from -pi on where it has a whole number of steps, else from 0 to beyond its end."""
    count = 2.0 ** float(values["bits"])
    whole = round(count)
    first, last = (-(whole // 2), whole - whole // 2) if _is_whole(count) else (0, whole + 1)
    return np.asarray(np.arange(first, last) * (TAU / count))


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    return [{"bits": float(bits)} for bits in range(5, 17)]


def derived(values: Parameters) -> Mapping[str, tuple[float, float, float, str]]:
    """The step of the grid."""
    step = 360.0 / 2.0 ** float(np.ravel(values["bits"])[0])
    return {"step_deg": (step, step, step, "deg")}


def stair(values: Parameters) -> float:
    """The step of the grid [rad]."""
    return float(TAU / 2.0 ** float(values["bits"]))


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """A word's rounding has the RMS step / sqrt 12."""
    return {"bits": np.round(np.log2(360.0 / (np.sqrt(12.0) * strength_deg)))}


OUTPUT_QUANTISATION = Effect(
    name="output_quantisation",
    stage="link",
    acts_on="angle",
    params={
        "bits": Param(
            unit="bit", null=0, lower=0, upper=40, doc="angle word, whole or not; 0: continuous", role="level"
        )
    },
    forward=forward,
    footprint="values",
    attainable=attainable,
    stair=stair,
    output_grid=True,
    drawing=drawing,
    shapes=shapes,
    derived=derived,
    needs=frozenset({"one turn"}),
    source="definition; noise of step/sqrt(12)",
    signature="every reading on a grid of 360/2^b degrees, or of few decimals",
)
