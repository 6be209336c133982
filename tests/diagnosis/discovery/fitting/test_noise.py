"""Noise of every kind: estimated to its sampling error, simulated alike, and accounted for by the predictive check.

The noises are made without the twin; what sampling theory says of an estimate is computed here from its textbook form.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.stats import norm
from scipy.stats import t as student

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise.distribution import TAIL, distribution
from diagnosis.discovery.proof.bootstrap import noise_of, twin_parameters
from diagnosis.discovery.proof.predictive_check import likeness
from tests.diagnosis.discovery.fitting.noises import KINDS, MOTION, RMS_RAD, Kind, density, fit_of, spectral_deviations
from twin.angles import TAU, Array, wrap
from twin.hall.noise import NOISE
from twin.motion import Motion
from twin.noise.description import Noise
from twin.noise.row_scale import RowScale, conditions

N = len(MOTION)
OMEGA = np.pi * (np.arange(N) + 0.5) / N
SIGMAS = 5.0
"""Estimates and simulated figures must lie within so many of their standard deviations: by chance 6 in 10^7 do not."""
each_kind = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)


SEEDS = range(16)


@dataclass(frozen=True, eq=False)
class Fitted:
    """A sweep with noise of one kind: its fit, the noise found, and the p of the predictive check."""

    fit: Fit
    noise: Noise
    p: float


@cache
def fitted(kind: Kind) -> tuple[Fitted, ...]:
    sweeps = []
    for seed in SEEDS:
        fit = fit_of(RMS_RAD * kind.draw(np.random.default_rng([seed, 1]), MOTION))
        noise = noise_of(fit)
        like = likeness(fit, rng=np.random.default_rng(seed), noise=noise)
        assert like is not None
        sweeps.append(Fitted(fit, noise, like.p))
    return tuple(sweeps)


def simulated_error(fit: Fit, parameters: Mapping[str, float], seed: int) -> Array:
    """Error (n,) of a sweep simulated from the fit's chain with this noise, in units of RMS_RAD."""
    chain = fit.chain.with_values({NOISE.name: parameters})
    sweep = chain.simulate(fit.observations.motion, seed=seed)
    return wrap(np.radians(sweep.measured_deg) - chain.readings(fit.observations.motion)) / RMS_RAD


# ---- estimated to its sampling error ------------------------------------------------------------------------------


def tail_deviations(dof: float) -> dict[str, float]:
    """Standard deviations of 1/dof and of the log of the RMS from n draws: Fisher's information by quadrature."""
    z = np.linspace(-400.0, 400.0, 400_001)

    def log_density(inverse: float, log_rms: float) -> Array:
        unit = np.exp(log_rms) * np.sqrt(1.0 - 2.0 * inverse)
        return np.asarray(student.logpdf(z / unit, 1.0 / inverse) - np.log(unit))

    weight = np.exp(log_density(1.0 / dof, 0.0)) * (z[1] - z[0])
    step = 1e-4
    by_inverse = (log_density(1.0 / dof + step, 0.0) - log_density(1.0 / dof - step, 0.0)) / (2.0 * step)
    by_rms = (log_density(1.0 / dof, step) - log_density(1.0 / dof, -step)) / (2.0 * step)
    slopes = np.stack([by_inverse, by_rms])
    deviations = np.sqrt(np.diag(np.linalg.inv((slopes * weight) @ slopes.T)) / N)
    return dict(zip(("inverse_dof", "log_rms"), deviations, strict=True))


def scale_deviations(noise: Noise) -> dict[str, float]:
    """Standard deviations of the slopes of the log RMS on what it depends on, and of its value where that is zero."""
    known = conditions(MOTION, MOTION.shaft_rad)
    names = [name for name in known if getattr(noise.scale, name)]
    design = np.concatenate([np.ones((1, N)), *(known[name] for name in names)])
    # The information on the log of its scale is 2 of a Gaussian reading, 2 dof / (dof + 3) of Student's t.
    told = 2.0 if np.isinf(noise.dof) else 2.0 * noise.dof / (noise.dof + 3.0)
    deviations = np.sqrt(np.diag(np.linalg.inv(told * design @ design.T)))
    return {"log_rms": float(deviations[0]), **{name: float(deviations[1 + place]) for place, name in enumerate(names)}}


def slopes(scale: RowScale) -> dict[str, float]:
    """Slopes of the log RMS on each condition; that on the angle by its size, its direction apart."""
    return {name: float(np.log1p(0.01 * getattr(scale, name))) for name in conditions(MOTION, MOTION.shaft_rad)}


def off(noise: Noise, truth: Noise) -> dict[str, float]:
    """By how much each parameter differs from the truth."""
    return {
        "log_rms": float(np.log(noise.rms_rad / RMS_RAD / truth.rms_rad)),
        "correlation": noise.correlation - truth.correlation,
        "flicker_exponent": noise.flicker_exponent - truth.flicker_exponent,
        "white_share": noise.white_share - truth.white_share,
        "inverse_dof": 1.0 / noise.dof - 1.0 / truth.dof,
        **{name: value - slopes(truth.scale)[name] for name, value in slopes(noise.scale).items()},
    }


@each_kind
def test_is_estimated_to_its_sampling_error(kind: Kind) -> None:
    """Of 16 sweeps each estimate lies within five standard deviations, their mean within five of its own.

    The compass search of a spectrum ends with steps of 1/128 of its range (0.9 of an exponent, 0.7 of a share, at most
    0.6 of a correlation). Where a sweep does not tell 1/f noise from correlated noise, with white noise beside them,
    one may stand for the other; a share or a correlation at the edge of its range errs to one side, by 0.4 of a
    standard deviation in the mean.
    """
    truth = kind.truth
    expected = scale_deviations(truth) if truth.white else spectral_deviations(truth)
    if np.isfinite(truth.dof):
        tail = tail_deviations(truth.dof)
        expected |= tail | {"log_rms": float(np.hypot(tail["log_rms"], expected["log_rms"]))}
    same = [one.noise for one in fitted(kind) if (one.noise.flicker_exponent > 0) == (truth.flicker_exponent > 0)]
    assert len(same) > len(SEEDS) / 2
    errors = [off(noise, truth) for noise in same]
    for name in errors[0]:
        # What is not there: no correlation but by chance, known to 1/sqrt(n), and of the rest nothing.
        deviation = expected.get(name, 1.0 / np.sqrt(N) if name == "correlation" else 0.0)
        resolution = 0.008 if name in ("correlation", "flicker_exponent", "white_share") else 1e-9
        error = np.array([one[name] for one in errors])
        assert np.all(np.abs(error) <= SIGMAS * deviation + resolution), name
        assert abs(np.mean(error)) <= (0.4 + SIGMAS / np.sqrt(error.size)) * deviation + resolution, name
    if truth.scale.angle_percent:
        turn = expected["angle_percent"] / slopes(truth.scale)["angle_percent"]
        phase = np.radians([noise.scale.angle_phase_deg - truth.scale.angle_phase_deg for noise in same])
        assert np.all(np.abs(phase) < SIGMAS * turn)


def test_rms_is_that_of_the_noise_not_of_what_a_fit_leaves() -> None:
    """Of 40 readings six parameters take as much as 8 % of the RMS; the mean over 160 sweeps is known to 1 %."""
    motion, sweeps = Motion.from_angle(shaft_rad=TAU / 40 * np.arange(40), direction=np.ones(40)), 160
    found = []
    for seed in range(sweeps):
        fit = fit_of(RMS_RAD * np.random.default_rng([seed, 2]).standard_normal(40), motion)
        found.append(noise_of(fit).rms_rad)
    deviation = 1.0 / np.sqrt(2.0 * (40 - 6) * sweeps)
    assert np.sqrt(np.mean(np.square(found))) == pytest.approx(RMS_RAD, rel=SIGMAS * deviation)


@pytest.mark.parametrize(("dof", "draws"), [(np.inf, 300), (4.0, 60)])
def test_even_noise_is_called_even(dof: float, draws: int) -> None:
    """A departure is found on plain noise as often as was asked for, in 5 % of all draws; of 300 in 28 at most, of 60
    in 9, in 0.2 % of cases each. That heavy-tailed noise has a tail is no false finding."""
    rows = {name: shape[:, ::2] for name, shape in conditions(MOTION, MOTION.shaft_rad).items()}
    del rows["percent_per_rpm"]
    rng = np.random.default_rng(4)
    wrong = 0
    for _ in range(draws):
        readings = rng.standard_normal(N // 2) if np.isinf(dof) else rng.standard_t(dof, N // 2)
        found = distribution(readings, rows, limit=10.0, log_p=np.log(0.05 / (len(rows) + np.isinf(dof))))
        wrong += bool(set(found.parts) - (set() if np.isinf(dof) else {TAIL}))
        assert np.isinf(dof) or TAIL in found.parts
    assert 0 < wrong <= 0.05 * draws + 3.0 * np.sqrt(0.05 * draws)


def test_readings_set_aside_do_not_hide_the_tail() -> None:
    """Readings beyond five of their scale left out: the tail of the rest is still that of four degrees of freedom."""
    draws = np.random.default_rng(5).standard_t(4.0, 20_000)
    kept = draws[np.abs(draws) < 5.0]
    slack = SIGMAS * tail_deviations(4.0)["inverse_dof"] * np.sqrt(N / kept.size)
    assert distribution(kept, {}, limit=5.0, log_p=-6.0).inverse_dof == pytest.approx(0.25, abs=slack)
    assert distribution(kept, {}, limit=1e6, log_p=-6.0).inverse_dof < 0.25 - slack


# ---- simulated alike ----------------------------------------------------------------------------------------------


def bands(values: Array) -> tuple[list[Array], Array]:
    """Fourier frequencies of eight bands, each wider than the one below, and the mean power in each."""
    window = np.hanning(values.size)
    power = np.abs(np.fft.rfft(values * window)) ** 2 / np.sum(window**2)
    edges = np.unique(np.geomspace(4, values.size // 2, 9).astype(int))
    parts = [np.arange(low, high) for low, high in itertools.pairwise(edges)]
    return [TAU * part / values.size for part in parts], np.array([np.mean(power[part]) for part in parts])


def whitened(noise: Noise, values: Array) -> Array:
    """Noise (n,) with its scale and distribution taken out of it: what is left is Gaussian, and has its colour."""
    values = values / (noise.rms_rad / RMS_RAD) / noise.scale.of(MOTION, MOTION.shaft_rad)
    if np.isinf(noise.dof):
        return values
    unit = np.sqrt((noise.dof - 2.0) / noise.dof)
    return np.asarray(norm.ppf(student.cdf(values / unit, noise.dof)))


@each_kind
def test_twin_simulates_what_was_fitted(kind: Kind) -> None:
    """Thirty sweeps from the twin against the law of the noise found: its spectrum, its tails and its scale.

    Law and scale are taken out of them, which leaves Gaussian noise with the spectrum. A band's power of a Hann window
    is known to sqrt(1.9 / frequencies) a sweep, a share of readings in a tail to 1 / sqrt(their number), and an RMS to
    1 / sqrt(2 readings). The lowest frequencies of a sequence that is mirrored at its ends differ by a few percent.
    """
    one, sweeps = fitted(kind)[0], 30
    values = twin_parameters(one.fit, one.noise)
    drawn = [whitened(one.noise, simulated_error(one.fit, values, seed)) for seed in range(sweeps)]
    omega, _ = bands(drawn[0])
    power = np.mean([bands(sweep)[1] for sweep in drawn], axis=0)
    expected = np.array([np.mean(density(one.noise, OMEGA)[np.searchsorted(OMEGA, part) - 1]) for part in omega])
    deviation = np.sqrt(1.9 / (sweeps * np.array([part.size for part in omega])))
    assert np.all(np.abs(np.log(power / expected)) < SIGMAS * deviation + 0.1)
    if not kind.truth.white:
        return
    together = np.abs(np.concatenate(drawn))
    for size in (1.0, 2.0, 3.0, 4.0):
        share = 2.0 * norm.sf(size)
        assert np.mean(together > size) == pytest.approx(share, rel=SIGMAS / np.sqrt(share * together.size))
    for quarter in np.array_split(np.argsort(kind.truth.scale.of(MOTION, MOTION.shaft_rad), kind="stable"), 4):
        rms = np.sqrt(np.mean(np.stack(drawn)[:, quarter] ** 2))
        assert rms == pytest.approx(1.0, abs=SIGMAS / np.sqrt(2.0 * sweeps * quarter.size))


# ---- accounted for by the predictive check ------------------------------------------------------------------------


@each_kind
def test_p_of_the_check_is_even(kind: Kind) -> None:
    """Of 16 even p-values more than 4 lie below 0.05 in 0.1 % of cases; their mean leaves 0.28 to 0.72 in 0.2 %."""
    p = np.array([one.p for one in fitted(kind)])
    assert np.count_nonzero(p < 0.05) <= 4
    assert 0.28 < np.mean(p) < 0.72


WITHOUT: dict[str, Callable[[Noise], Noise]] = {
    "AR(1)": lambda noise: replace(noise, correlation=0.0),
    "AR(1) + white": lambda noise: replace(noise, white_share=0.0),
    "1/f": lambda noise: replace(noise, flicker_exponent=0.0, correlation=0.5 + 0.4 * noise.flicker_exponent),
    "1/f + white": lambda noise: replace(noise, white_share=0.0),
    "t with 4 degrees of freedom": lambda noise: replace(noise, dof=np.inf),
    "louder backward": lambda noise: replace(noise, scale=RowScale()),
    "louder when warm": lambda noise: replace(noise, scale=RowScale()),
    "louder when fast": lambda noise: replace(noise, scale=RowScale()),
    "louder on one side": lambda noise: replace(noise, scale=RowScale()),
    "t with 4 degrees of freedom, louder backward": lambda noise: replace(noise, scale=RowScale()),
}
"""By kind, a noise that lacks what makes it this kind."""


@pytest.mark.parametrize("kind", [k for k in KINDS if k.name in WITHOUT], ids=lambda kind: kind.name)
def test_the_check_fails_without_what_makes_the_kind(kind: Kind) -> None:
    """Of six sweeps at least four have a p below 0.05: by chance in 1 of 12,000 cases."""
    low = 0
    for seed, one in zip(SEEDS[:6], fitted(kind)[:6], strict=True):
        like = likeness(one.fit, rng=np.random.default_rng(seed), noise=WITHOUT[kind.name](one.noise))
        assert like is not None
        low += like.p < 0.05
    assert low >= 4
