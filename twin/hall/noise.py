"""noise: what the channels add of their own; see :mod:`twin.noise` for its spectrum and its distribution."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion
from twin.noise.description import Noise
from twin.noise.row_scale import RowScale
from twin.noise.sequences import autoregressive, draw, innovations, turned


def described(values: Parameters) -> Noise:
    """The noise (of RMS 1) that the effect's parameters describe; in a batch all have the first one's shape."""
    inverse = _first(values, "inverse_dof")
    return Noise(
        correlation=_first(values, "correlation"),
        flicker_exponent=_first(values, "flicker_exponent"),
        white_share=1.0 - _first(values, "correlated_share"),
        ringing_per_reading=_first(values, "ringing_per_reading"),
        ringing_quality=_first(values, "ringing_quality"),
        dof=1.0 / inverse if inverse > 0.0 else np.inf,
        scale=RowScale(**{name: _first(values, name) for name in _SCALE}),
    )


def _first(values: Parameters, name: str) -> float:
    return float(np.ravel(values.get(name, NOISE.params[name].null))[0])


def parameters(noise: Noise) -> dict[str, float]:
    """The effect's parameters for a noise of the angle."""
    return {
        "rms_deg": float(np.degrees(noise.rms_rad)),
        "correlation": noise.correlation,
        "correlated_share": 1.0 - noise.white_share,
        "flicker_exponent": noise.flicker_exponent,
        "ringing_per_reading": noise.ringing_per_reading,
        "ringing_quality": noise.ringing_quality if noise.rings else NOISE.params["ringing_quality"].null,
        "inverse_dof": 1.0 / noise.dof,
        # Of even Gaussian white noise each channel's is that of the angle.
        "rotating_frame": 0.0 if noise.white and np.isinf(noise.dof) else 1.0,
        **{name: getattr(noise.scale, name) for name in _SCALE},
    }


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    if rng is None:
        return signal
    noise = described(values)
    size = radians(values["rms_deg"])
    if not noise.scale.even:
        size = size * noise.scale.of(motion, np.arctan2(signal[..., 1:, :], signal[..., :1, :]))
    if _first(values, "rotating_frame") == 0.0:
        return signal + size * _of_each_channel(rng, signal.shape, noise, _first(values, "correlated_share"))
    along, across = np.moveaxis(size * draw(rng, signal.shape, noise.spectrum(len(motion)), dof=noise.dof), -2, 0)
    return turned(signal * (1.0 + along[..., None, :]), across)


def _of_each_channel(rng: np.random.Generator, shape: tuple[int, ...], noise: Noise, share: float) -> Array:
    """Noise (..., 2, n) of unit variance, of which this share is coloured: alike in both channels, yet independent."""
    unit = innovations(rng, shape, dof=noise.dof)
    if noise.white:
        return unit
    if noise.flicker_exponent == 0.0 and not noise.rings:
        coloured = autoregressive(rng, shape, noise.correlation, dof=noise.dof)
    else:
        coloured = draw(rng, shape, replace(noise, white_share=0.0).spectrum(shape[-1]), dof=noise.dof)
    return np.asarray(np.sqrt(1.0 - share) * unit + np.sqrt(share) * coloured)


def _shape(unit: str, null: float, bounds: tuple[float, float], doc: str, *, typical: float = 0.1) -> Param:
    return Param(
        unit=unit,
        null=null,
        lower=bounds[0],
        upper=bounds[1],
        doc=doc,
        role="shape",
        typical=typical,
        owner="recording",
    )


_SCALE = {
    "backward_percent": _shape("%", 0.0, (-99.0, 1e4), "more RMS backward than forward", typical=50.0),
    "percent_per_K": _shape("%/K", 0.0, (-50.0, 50.0), "more RMS with each kelvin above 25 C", typical=1.0),
    "percent_per_rpm": _shape("%/rpm", 0.0, (-50.0, 50.0), "more RMS with each rpm of speed", typical=0.1),
    "angle_percent": _shape("%", 0.0, (0.0, 1e4), "more RMS on one side of the turn", typical=50.0),
    "angle_phase_deg": replace(
        _shape("deg", 0.0, (-180.0, 180.0), "sensor angle of that side", typical=10.0), mirror=-1
    ),
}

NOISE = Effect(
    name="noise",
    stage="hall",
    acts_on="channels",
    params={
        "rms_deg": Param(
            unit="deg",
            null=0.0,
            lower=0.0,
            upper=180.0,
            doc="RMS in the angle",
            role="random",
            field_power=-1.0,
            owner="recording",
        ),
        "correlation": _shape("1", 0.0, (0.0, 0.999), "from one reading to the next", typical=0.5),
        "correlated_share": _shape("1", 1.0, (0.0, 1.0), "share of the variance that is correlated or 1/f"),
        "flicker_exponent": _shape("1", 0.0, (0.0, 2.5), "exponent a of 1/f^a noise", typical=0.5),
        "ringing_per_reading": _shape("1", 0.0, (0.0, 0.5), "resonance of a narrow band, cycles a reading; 0: none"),
        "ringing_quality": _shape("1", 10.0, (0.5, 1e3), "quality of that resonance", typical=5.0),
        "inverse_dof": _shape("1", 0.0, (0.0, 0.45), "1 over the degrees of freedom of Student's t; 0: Gaussian"),
        "rotating_frame": Param(
            unit="1",
            null=0.0,
            lower=0.0,
            upper=1.0,
            doc="1: the spectrum is that of angle and radius, 0: of each channel",
            role="shape",
            counts=True,
            owner="recording",
        ),
        **_SCALE,
    },
    forward=forward,
    footprint="spread",
    source="thermal and 1/f noise of the Hall plates, as first-order autoregressive, 1/f and white noise; a bracket "
    "that rings",
    signature="spread of the readings",
    baseline=True,
)
