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


def full_scale() -> Param:
    """The parameter that says how far the converter's codes reach, for every effect that makes some of the channels.

    The range is fixed in volts: in amplitudes it grows as the field falls.
    """
    return Param(
        unit="%",
        null=100.0 * FULL_SCALE,
        lower=1.0,
        upper=1e4,
        doc="full scale of the codes, in amplitudes",
        role="shape",
        typical=5.0,
        field_power=-1.0,
        aside=True,
    )


def range_of(values: Parameters) -> Array:
    """The full scale in amplitudes: of a batch (batch, 1, 1), else one number."""
    return 0.01 * np.asarray(values.get("full_scale_percent", 100.0 * FULL_SCALE), dtype=np.float64)[()]


def codes_of(signal: Array, bits: Any, amplitudes: Any = FULL_SCALE) -> NDArray[np.int64]:
    """Signed codes of channels (any shape), clipped to words of this many bits; ``amplitudes``: their full scale."""
    half = 2.0 ** (np.asarray(bits, dtype=np.float64) - 1.0)
    return np.asarray(np.clip(np.round(signal / amplitudes * half), -half, half - 1.0), dtype=np.int64)


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    bits = np.asarray(values["bits"], dtype=np.float64)
    # The channels' own noise dithers this grid: in expectation it does nothing.
    if rng is None or np.all(bits == 0):
        return signal
    reach = range_of(values)
    return np.asarray(codes_of(signal, bits, reach) * (2.0 * reach / 2.0**bits))


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
            typical=10.0,
        ),
        "full_scale_percent": full_scale(),
    },
    forward=forward,
    footprint="spread",
    baseline=True,
    source="paper, Eq. 3 and 7",
    signature="noise of step/sqrt(12) on each channel",
)
