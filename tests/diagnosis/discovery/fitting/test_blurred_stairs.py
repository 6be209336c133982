"""Stairs behind noise: mean and variance of what is read, as a function of the angle."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.discovery.fitting.blurred_stairs import blurred_stairs
from diagnosis.discovery.fitting.linearised_chain import Linear
from twin.angles import TAU, Array, wrap
from twin.catalogue import find
from twin.chain import Chain
from twin.motion import Motion

STEP = TAU / 2**9
ANGLES = np.random.default_rng(3).uniform(-np.pi, np.pi, 40)
DRAWS = 200_000


def drawn(name: str, values: dict[str, float], blur: float) -> Array:
    """Readings away from the angles with noise ahead of the stairs (draws, angles) [rad]."""
    noisy = ANGLES + blur * np.random.default_rng(5).standard_normal((DRAWS, ANGLES.size))
    rest = Motion.from_angle(np.zeros(ANGLES.size))
    return np.asarray(find(name).forward(noisy[:, None, :], rest, values, None)[:, 0] - ANGLES)


@pytest.mark.parametrize("share", [0.1, 0.3, 1.0])
@pytest.mark.parametrize(
    ("name", "values"), [("output_quantisation", {"bits": 9.0}), ("cordic_truncation", {"iterations": 8.0})]
)
def test_mean_and_variance_are_those_of_noisy_readings(name: str, values: dict[str, float], share: float) -> None:
    """As many draws tell a mean to its standard error and a variance to sqrt(2/draws); five of these each.

    Beside them the table's own error: an edge lies anywhere between two points of it, an eighth of the blur or less,
    which moves a mean by up to a step times the density there, 0.4 / 8 of it in all, spread over the edges' places.
    """
    blur = share * STEP
    mean, variance = blurred_stairs([(find(name), values)], blur).at(ANGLES)
    away = drawn(name, values, blur)
    scatter = away.std(axis=0)
    table = 0.03 * STEP
    assert np.all(np.abs(mean - away.mean(axis=0)) < 5.0 * scatter / np.sqrt(DRAWS) + table)
    assert np.sqrt(np.mean(variance)) == pytest.approx(np.sqrt(np.mean(scatter**2)), rel=0.03)


def test_the_mean_is_smooth() -> None:
    """Behind noise of a step and more rounding leaves a ripple of exp(-2 pi^2) of the step: nothing."""
    mean, _ = blurred_stairs([(find("output_quantisation"), {"bits": 9.0})], 1.2 * STEP).at(np.linspace(-4.0, 4.0, 999))
    # The first harmonic of a saw tooth is step/pi; points of a table on whole shares of a step leave none.
    assert np.max(np.abs(mean)) < STEP / np.pi * np.exp(-2.0 * (np.pi * 1.2) ** 2) + 1e-12


def test_stairs_round_the_angle_that_reaches_them() -> None:
    """The expectation is the mean of the chain's own readings, with an order ahead of the grid of the output.

    Of so many draws the means scatter by noise and grid over their root; the RMS over 90 readings of that.
    """
    motion = Motion.from_angle(np.linspace(0.0, TAU, 90, endpoint=False))
    chain = Chain().with_effect("unnamed_order", order=9.0, amplitude_deg=0.05, phase_deg=20.0)
    chain = chain.with_effect("output_quantisation", bits=12)
    noisy, draws = chain.with_effect("noise", rms_deg=0.01), 400
    expected = Linear(chain, motion, blur=float(np.radians(0.01)), observables=1).angle
    drawn = np.stack([np.radians(noisy.simulate(motion, seed=seed).measured_deg) for seed in range(draws)])
    bias = np.mean(wrap(drawn - expected), axis=0)
    scatter = np.radians(360.0 / 2**12) / np.sqrt(draws)
    assert np.sqrt(np.mean(bias**2)) < scatter


def test_angles_beyond_a_turn_are_the_same() -> None:
    stairs = blurred_stairs([(find("output_quantisation"), {"bits": 9.0})], 0.2 * STEP)
    for one, other in zip(stairs.at(ANGLES), stairs.at(ANGLES + 3.0 * TAU), strict=True):
        # Rounding of an angle of 20 rad on a curve whose slope is below 1/0.2.
        assert np.allclose(one, other, rtol=0.0, atol=1e-13)
