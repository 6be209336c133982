"""reference_quantisation: the reference reads whole counts, while the shaft stands between two of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import TAU, Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion

_STEPS_OF_RMS = float(np.sqrt(12.0))
"""A step is so many times the RMS of what rounding to it leaves."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal + radians(values["step_deg"]) * _off(motion, np.asarray(values["counts_per_turn"]))


def _off(motion: Motion, counts_per_turn: Array) -> Array:
    """What the rounding adds to each reading (..., n), in counts.

    Of a motion that was recorded in these counts it is told by the way on which they lie, of any other by its angles.
    """
    recorded = motion.whole_counts
    if recorded is not None and np.all(counts_per_turn == recorded.counts_per_turn):
        return recorded.off
    # In a file of few decimals of a radian each turn is counted from its own zero.
    turned = np.mod(motion.recorded_rad, TAU) * (counts_per_turn / TAU)
    return np.asarray(np.round(turned) - turned)


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    recorded = motion.whole_counts
    return [] if recorded is None else [{"counts_per_turn": recorded.counts_per_turn}]


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """As many counts as make rounding of this RMS."""
    counts = np.round(360.0 / (_STEPS_OF_RMS * strength_deg))
    return {"counts_per_turn": counts, "step_deg": 360.0 / counts}


REFERENCE_QUANTISATION = Effect(
    name="reference_quantisation",
    stage="reference",
    acts_on="reference",
    params={
        "step_deg": Param(
            unit="deg",
            null=0.0,
            lower=0.0,
            upper=10.0,
            doc="the step by what the readings show of its rounding: 360 over the counts, less where the way is uneven",
            typical=0.1 * _STEPS_OF_RMS,
        ),
        "counts_per_turn": Param(
            unit="1/turn",
            null=4000,
            lower=2,
            upper=1e6,
            doc="counts of the reference, as its values show them",
            role="shape",
        ),
    },
    forward=forward,
    shapes=shapes,
    drawing=drawing,
    needs=frozenset({"a reference", "whole counts"}),
    source="definition; W. R. Bennett, Spectra of quantized signals, Bell System Technical Journal 27 (1948): "
    "noise of step/sqrt(12), which at even readings is lines",
    signature="a sawtooth of the counts; at even readings lines where its orders fold to",
)
