"""Noises of every kind, made here without the twin, and fits of the paper's error model to sweeps that hold them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.search.likelihood_ratio import settle
from diagnosis.discovery.stages.initial_fit import initial_fit
from diagnosis.discovery.stages.observe import observe
from diagnosis.discovery.stages.row_masks import row_masks
from diagnosis.discovery.state import Stage, State
from tests.hidden.noise import Noise as Hidden
from twin.angles import TAU, Array
from twin.chain import Chain
from twin.contract import full_motion
from twin.motion import Motion
from twin.noise.description import Noise
from twin.noise.row_scale import RowScale
from twin.sweep import Sweep

RMS_RAD = 3e-4
"""0.017 deg."""
MOTION = full_motion(points=90)
"""1440 readings: two turns in both directions at two speeds and two temperatures."""


@dataclass(frozen=True)
class Kind:
    """A noise: ``draw`` makes it (n,) on a motion in units of RMS_RAD, ``truth`` describes it in the same units."""

    name: str
    draw: Callable[[np.random.Generator, Motion], Array]
    truth: Noise


def _white(rng: np.random.Generator, motion: Motion) -> Array:
    return rng.standard_normal(len(motion))


def _ar1(correlation: float, share: float = 1.0) -> Callable[[np.random.Generator, Motion], Array]:
    def draw(rng: np.random.Generator, motion: Motion) -> Array:
        coloured = Hidden("ar1", 1.0, correlation).sample(rng, len(motion))
        return np.asarray(np.sqrt(share) * coloured + np.sqrt(1.0 - share) * rng.standard_normal(len(motion)))

    return draw


def _flicker(exponent: float, share: float = 1.0) -> Callable[[np.random.Generator, Motion], Array]:
    def draw(rng: np.random.Generator, motion: Motion) -> Array:
        # The middle of a sequence eight times as long, which is as slow as it pleases.
        n = len(motion)
        omega = np.pi * np.arange(4 * n + 1) / (4 * n)
        gain = np.append(0.0, omega[1:] ** (-0.5 * exponent))
        slow = np.fft.irfft(np.fft.rfft(rng.standard_normal(8 * n)) * gain, 8 * n)[3 * n : 4 * n]
        # RMS 1 over the frequencies that a record of n readings holds.
        held = np.pi * (np.arange(n) + 0.5) / n
        slow = slow / np.sqrt(np.mean(held**-exponent))
        return np.asarray(np.sqrt(share) * slow + np.sqrt(1.0 - share) * rng.standard_normal(n))

    return draw


def _student(dof: float) -> Callable[[np.random.Generator, Motion], Array]:
    def draw(rng: np.random.Generator, motion: Motion) -> Array:
        return np.asarray(rng.standard_t(dof, len(motion)) * np.sqrt((dof - 2.0) / dof))

    return draw


def _scaled(scale: Callable[[Motion], Array], dof: float = np.inf) -> Callable[[np.random.Generator, Motion], Array]:
    def draw(rng: np.random.Generator, motion: Motion) -> Array:
        unit = _white(rng, motion) if np.isinf(dof) else _student(dof)(rng, motion)
        return np.asarray(scale(motion) * unit)

    return draw


KINDS = (
    Kind("white", _white, Noise()),
    Kind("AR(1)", _ar1(0.7), Noise(correlation=0.7)),
    Kind("AR(1) + white", _ar1(0.9, 0.6), Noise(correlation=0.9, white_share=0.4)),
    Kind("1/f", _flicker(1.0), Noise(flicker_exponent=1.0)),
    Kind("1/f + white", _flicker(1.0, 0.6), Noise(flicker_exponent=1.0, white_share=0.4)),
    Kind("t with 4 degrees of freedom", _student(4.0), Noise(dof=4.0)),
    Kind(
        "louder backward",
        _scaled(lambda m: np.where(m.direction < 0.0, 1.6, 1.0)),
        Noise(scale=RowScale(backward_percent=60.0)),
    ),
    Kind(
        "louder when warm",
        _scaled(lambda m: 1.015 ** (m.temperature_c - 25.0)),
        Noise(scale=RowScale(percent_per_K=1.5)),
    ),
    Kind(
        "louder when fast",
        _scaled(lambda m: 1.002 ** (np.abs(m.speed_rad_s) * 60.0 / TAU)),
        Noise(scale=RowScale(percent_per_rpm=0.2)),
    ),
    Kind(
        "louder on one side",
        _scaled(lambda m: 1.7 ** np.cos(m.shaft_rad - np.radians(70.0))),
        Noise(scale=RowScale(angle_percent=70.0, angle_phase_deg=70.0)),
    ),
    Kind(
        "t with 4 degrees of freedom, louder backward",
        _scaled(lambda m: np.where(m.direction < 0.0, 1.6, 1.0), 4.0),
        Noise(dof=4.0, scale=RowScale(backward_percent=60.0)),
    ),
)


def swept(error_rad: Array, motion: Motion = MOTION) -> Sweep:
    """A sweep of an ideal sensor with these errors (n,) [rad]."""
    reading = np.degrees(motion.shaft_rad + error_rad) % 360.0
    reference = np.degrees(motion.shaft_rad) % 360.0
    return Sweep.from_motion(motion, reference_deg=reference, measured_deg=reading, channels=None)


def fit_of(error_rad: Array, motion: Motion = MOTION, *stages: Stage) -> Fit:
    """The paper's error model fitted to such a sweep, and what further stages of the discovery make of the fit."""
    state = State.of(swept(error_rad, motion), Chain())
    for stage in (observe, initial_fit, row_masks, *stages):
        state = stage(state)
    return settle(state.fit)[0]


# ---- what sampling theory says of a spectrum ----------------------------------------------------------------------


def density(noise: Noise, omega: Array) -> Array:
    """Spectral density over angular frequencies that a record holds, of mean 1 over these."""
    shape = np.abs(1.0 - noise.correlation * np.exp(1j * omega)) ** -2.0 * omega**-noise.flicker_exponent
    share = 0.0 if noise.correlation == noise.flicker_exponent == 0.0 else noise.white_share
    return np.asarray((1.0 - share) * shape / np.mean(shape) + share)


def spectral_deviations(noise: Noise) -> dict[str, float]:
    """Standard deviations of its parameters from n readings: Whittle's information, half the sum of squared slopes."""
    omega = np.pi * (np.arange(len(MOTION)) + 0.5) / len(MOTION)
    moved: dict[str, Callable[[float], Array]] = {"log_rms": lambda d: np.exp(2.0 * d) * density(noise, omega)}
    name = "correlation" if noise.correlation else "flicker_exponent"
    if getattr(noise, name):
        moved[name] = lambda d: density(replace(noise, **{name: getattr(noise, name) + d}), omega)
        moved["white_share"] = lambda d: density(replace(noise, white_share=noise.white_share + d), omega)
    slopes = np.stack([(np.log(of(1e-5)) - np.log(of(-1e-5))) / 2e-5 for of in moved.values()])
    return dict(zip(moved, np.sqrt(np.diag(np.linalg.inv(0.5 * slopes @ slopes.T))), strict=True))
