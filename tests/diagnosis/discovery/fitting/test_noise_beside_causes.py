"""Noise beside causes in the spread and ahead of stairs: each is simulated by its own part of the twin, and once."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.proof.bootstrap import noise_of, simulated, twin_parameters
from diagnosis.discovery.proof.predictive_check import likeness
from diagnosis.discovery.stages.quantisation import quantisation
from diagnosis.discovery.stages.spread import spread
from tests.diagnosis.discovery.fitting.noises import MOTION, RMS_RAD, fit_of, spectral_deviations
from tests.hidden.noise import Noise as Hidden
from twin.angles import TAU, Array, wrap
from twin.contract import full_motion
from twin.hall.noise import NOISE
from twin.noise.description import Noise

N = len(MOTION)
SIGMAS = 5.0
STRETCH = slice(500, 760)
STEP = TAU / 2**13
"""0.044 deg."""
UNEVEN = full_motion(points=97)
"""Steps of the shaft that fall anywhere between two of the grid's."""


def simulated_errors(fit: Fit, noise: Noise, sweeps: int) -> Array:
    """Errors (sweeps, n) [rad] of sweeps simulated from the fit's chain with this noise."""
    chain = fit.chain.with_values({NOISE.name: twin_parameters(fit, noise)})
    ideal = fit.linear.angle
    return np.stack(
        [wrap(np.radians(chain.simulate(MOTION, seed=seed).measured_deg) - ideal) for seed in range(sweeps)]
    )


@pytest.mark.parametrize("correlation", [0.0, 0.8])
def test_a_noisy_stretch_is_simulated_once(correlation: float) -> None:
    """Noise, and in one stretch white noise of twice its RMS beside it: RMS within and without, as they went in.

    A standard deviation of m readings is known to 1/sqrt(2m), less the more they are correlated; one sweep tells of
    what ten simulated ones show. The stretch's edges are found to a few rows.
    """
    rng = np.random.default_rng(11)
    error = Hidden("ar1" if correlation else "white", RMS_RAD, correlation).sample(rng, N)
    error[STRETCH] += 2.0 * RMS_RAD * rng.standard_normal(STRETCH.stop - STRETCH.start)
    fit = fit_of(error, MOTION, spread)
    assert "unnamed_burst" in fit.chain.values
    found = noise_of(fit)
    alike = simulated_errors(fit, found, 10) / RMS_RAD
    inside = np.zeros(N, dtype=bool)
    inside[STRETCH] = True
    widened = (1.0 + correlation**2) / (1.0 - correlation**2)
    for rows, expected in ((inside, np.sqrt(5.0)), (~inside, 1.0)):
        deviation = np.sqrt(1.1 * widened / (2.0 * np.count_nonzero(rows)))
        assert np.sqrt(np.mean(alike[:, rows] ** 2)) == pytest.approx(expected, rel=SIGMAS * deviation)
    if correlation:
        quiet = alike[:, : STRETCH.start - 20]
        slack = SIGMAS * np.sqrt(1.1 * (1.0 - correlation**2) / quiet.shape[1])
        seen = np.mean(quiet[:, 1:] * quiet[:, :-1]) / np.mean(quiet**2)
        assert seen == pytest.approx(correlation, abs=slack + 0.008)


def jittered(seed: int) -> tuple[Fit, Array]:
    """Correlated noise, and white jitter of three times its RMS that goes with sin 2a; |sin 2a| (n,) beside the fit."""
    rng = np.random.default_rng(seed)
    sine = np.abs(np.sin(2.0 * MOTION.shaft_rad))
    error = Hidden("ar1", RMS_RAD, 0.7).sample(rng, N) + 3.0 * RMS_RAD * sine * rng.standard_normal(N)
    fit = fit_of(error, MOTION, spread)
    assert "reference_jitter" in fit.chain.values
    return fit, sine


def test_jitter_of_the_reference_is_simulated_once() -> None:
    """In thirds of the readings, from quiet to loud, the RMS that went in."""
    fit, sine = jittered(12)
    alike = simulated_errors(fit, noise_of(fit), 10) / RMS_RAD
    for rows in np.array_split(np.argsort(sine, kind="stable"), 3):
        expected = np.sqrt(1.0 + 9.0 * np.mean(sine[rows] ** 2))
        # Three thirds share two parameters; the correlation takes from the quiet third.
        deviation = np.sqrt(1.1 * 2.9 / (2.0 * rows.size))
        assert np.sqrt(np.mean(alike[:, rows] ** 2)) == pytest.approx(expected, rel=SIGMAS * deviation)


def test_jitter_is_not_taken_for_a_white_share_of_the_noise() -> None:
    """All of the noise itself is correlated: the mean share over eight sweeps, each of which tells it to a fifth.

    Two thirds of the variance, in units of each row's own, is jitter. How much of it is white is known as of that much
    white noise beside correlated noise; of the noise alone, a third of it, three times as badly. A share has no more
    than all.
    """
    shares = [twin_parameters(fit, noise_of(fit))["correlated_share"] for fit, _ in map(jittered, range(12, 20))]
    deviation = 3.0 * spectral_deviations(Noise(correlation=0.7, white_share=2.0 / 3.0))["white_share"]
    assert np.mean(shares) > 1.0 - SIGMAS * deviation / np.sqrt(8.0)
    assert SIGMAS * deviation / np.sqrt(8.0) < 0.5


ROUNDED = ((0.0, 0.3), (0.0, 0.6), (0.8, 0.4))
"""Correlation of the noise, and its RMS in steps of the grid."""


@pytest.mark.parametrize(("correlation", "ratio"), ROUNDED)
def test_noise_ahead_of_a_grid_is_told_from_rounding(correlation: float, ratio: float) -> None:
    """Its RMS: that of the readings, known to 1/sqrt(2n), less the grid's, which magnifies the error by their squares.

    Of correlated noise the correlation too, which rounding hides: five standard deviations of a first-order noise with
    as much white noise beside it as rounding adds.
    """
    rng = np.random.default_rng(13)
    noise = ratio * STEP * Hidden("ar1" if correlation else "white", 1.0, correlation).sample(rng, len(UNEVEN))
    reading = np.round((UNEVEN.shaft_rad + noise) / STEP) * STEP
    fit = fit_of(reading - UNEVEN.shaft_rad, UNEVEN, quantisation)
    assert fit.weighting.blur > 0.0
    told = twin_parameters(fit, noise_of(fit))
    total = 1.0 + 1.0 / (12.0 * ratio**2)
    widened = (1.0 + correlation**2) / (1.0 - correlation**2)
    slack = SIGMAS * total * np.sqrt(widened / (2.0 * len(UNEVEN)))
    assert np.radians(told["rms_deg"]) / STEP == pytest.approx(ratio, rel=slack)
    if correlation:
        expected = spectral_deviations(Noise(correlation=correlation, white_share=1.0 - 1.0 / total))
        assert told["correlation"] == pytest.approx(correlation, abs=SIGMAS * expected["correlation"])
        assert told["correlated_share"] > 1.0 - SIGMAS * total * expected["white_share"]
    else:
        assert told["correlation"] < SIGMAS / np.sqrt(len(UNEVEN))


def test_p_of_the_check_is_even_ahead_of_a_grid() -> None:
    """Of 12 even p-values more than 3 lie below 0.05 in 0.2 % of cases; their mean leaves 0.24 to 0.76 in 0.2 %."""
    p = []
    for seed in range(12):
        noise = 0.35 * STEP * Hidden("ar1", 1.0, 0.6).sample(np.random.default_rng([seed, 14]), len(UNEVEN))
        reading = np.round((UNEVEN.shaft_rad + noise) / STEP) * STEP
        like = likeness(fit_of(reading - UNEVEN.shaft_rad, UNEVEN, quantisation), rng=np.random.default_rng(seed))
        assert like is not None
        p.append(like.p)
    assert np.count_nonzero(np.array(p) < 0.05) <= 3
    assert 0.24 < np.mean(p) < 0.76


@pytest.mark.parametrize("correlation", [0.0, 0.8])
def test_twin_and_bootstrap_simulate_alike(correlation: float) -> None:
    """Both draw heavy-tailed noise by the same code: quantiles of twenty sweeps each, to five deviations of them."""
    rng = np.random.default_rng(15)
    error = RMS_RAD * rng.standard_t(4.0, N)
    for row in range(1, N):
        error[row] += correlation * error[row - 1]
    fit = fit_of(error)
    found = noise_of(fit)
    assert np.isfinite(found.dof)
    from_twin = simulated_errors(fit, found, 20).ravel()
    from_bootstrap = simulated(fit, found, count=20, rng=np.random.default_rng(1)).ravel()
    for share in (0.02, 0.16, 0.5, 0.84, 0.98):
        low, quantile, high = np.quantile(from_twin, [share - 0.005, share, share + 0.005])
        slope = 0.01 / (high - low)
        widened = (1.0 + correlation) / (1.0 - correlation)
        deviation = np.sqrt(2.0 * widened * share * (1.0 - share) / from_twin.size) / slope
        assert np.quantile(from_bootstrap, share) == pytest.approx(quantile, abs=SIGMAS * deviation)
