"""noise: what the channels add of their own, white or correlated from reading to reading."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def autoregressive(rng: np.random.Generator, shape: tuple[int, ...], correlation: float) -> Array:
    """Stationary first-order autoregressive noise of unit variance along the last axis."""
    white = rng.standard_normal(shape)
    if correlation == 0.0:
        return white
    out = np.empty(shape)
    state = white[..., 0]
    out[..., 0] = state
    innovation = np.sqrt(1.0 - correlation**2)
    for k in range(1, shape[-1]):
        state = correlation * state + innovation * white[..., k]
        out[..., k] = state
    return out


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    if rng is None:
        return signal
    share = float(np.ravel(values.get("correlated_share", 1.0))[0])
    correlation = float(np.ravel(values.get("correlation", 0.0))[0])
    noise = rng.standard_normal(signal.shape)
    if correlation != 0.0:
        noise = np.sqrt(1.0 - share) * noise + np.sqrt(share) * autoregressive(rng, signal.shape, correlation)
    return signal + radians(values["rms_deg"]) * noise


NOISE = Effect(
    name="noise",
    stage="hall",
    acts_on="channels",
    params={
        "rms_deg": Param(
            unit="deg", null=0.0, lower=0.0, upper=20.0, doc="RMS in the angle", role="random", field_power=-1.0
        ),
        "correlation": Param(
            unit="1",
            null=0.0,
            lower=0.0,
            upper=0.999,
            doc="from one reading to the next",
            role="shape",
            typical=0.5,
        ),
        "correlated_share": Param(
            unit="1",
            null=1.0,
            lower=0.0,
            upper=1.0,
            doc="share of the variance that is correlated",
            role="shape",
        ),
    },
    forward=forward,
    footprint="spread",
    source="thermal and 1/f noise of the Hall plates, as first-order autoregressive noise plus white noise",
    signature="spread of the readings",
    baseline=True,
)
