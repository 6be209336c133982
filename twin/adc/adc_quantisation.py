"""adc_quantisation: the converter rounds each channel to its grid."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion

FULL_SCALE = 1.25
"""Full scale in nominal amplitudes: a quarter of head-room, a typical assumption."""


def codes_of(signal: Array, bits: Any) -> NDArray[np.int64]:
    """Signed codes of channels (any shape) of nominal amplitude 1, clipped to words of this many bits."""
    half = 2.0 ** (np.asarray(bits, dtype=np.float64) - 1.0)
    return np.asarray(np.clip(np.round(signal / FULL_SCALE * half), -half, half - 1.0), dtype=np.int64)


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    bits = np.asarray(values["bits"], dtype=np.float64)
    # The channels' own noise dithers this grid: in expectation it does nothing.
    if rng is None or np.all(bits == 0):
        return signal
    return np.asarray(codes_of(signal, bits) * (2.0 * FULL_SCALE / 2.0**bits))


ADC_QUANTISATION = Effect(
    name="adc_quantisation",
    stage="adc",
    acts_on="channels",
    params={
        "bits": Param(
            unit="bit",
            null=0,
            lower=0,
            upper=32,
            doc="word length; 0: continuous",
            role="random",
            counts=True,
        )
    },
    forward=forward,
    footprint="spread",
    baseline=True,
    source="paper, Eq. 3 and 7",
    signature="noise of step/sqrt(12) on each channel",
)
