"""reference_jitter: white noise of the converter's reference, independent for the conversions of x and y."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    if rng is None:
        return signal
    return signal * (1.0 + 0.01 * np.asarray(values["percent_rms"]) * rng.standard_normal(signal.shape))


def spread(angle: Array, values: Parameters) -> Array:
    """Variance (n,) [rad^2] added at the sensor angle (n,) [rad]: e = sin(2a)/2 times the difference of two draws."""
    return np.asarray(0.5 * (0.01 * np.asarray(values["percent_rms"])) ** 2 * np.sin(2.0 * angle) ** 2)


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """e = sin 2a / 2 times the difference of two draws: RMS 0.5 p."""
    return {"percent_rms": 200.0 * radians(strength_deg)}


REFERENCE_JITTER = Effect(
    name="reference_jitter",
    stage="adc",
    acts_on="channels",
    params={
        "percent_rms": Param(
            unit="%", null=0.0, lower=0.0, upper=20.0, doc="RMS of the reference", role="random", typical=0.1
        )
    },
    forward=forward,
    needs=frozenset({"one turn"}),
    footprint="spread",
    spread=spread,
    drawing=drawing,
    source="paper, Eq. 3: the sampling error is proportional to the code",
    signature="noise whose variance follows sin^2 2a",
)
