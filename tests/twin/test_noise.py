"""The noise that a twin simulates has the spectrum, the tails and the scale that its parameters say.

What is expected is computed here from the textbook formulae, not by the twin.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from scipy.stats import t as student

from twin.angles import TAU, Array, wrap
from twin.chain import Chain
from twin.contract import full_motion
from twin.hall.noise import described, parameters
from twin.motion import Motion
from twin.noise.description import Noise
from twin.noise.row_scale import RowScale

RMS_RAD = 1e-3


def steady(points: int, turns: int) -> Motion:
    """A shaft that turns one way in even steps."""
    return Motion.from_angle(shaft_rad=TAU / points * np.arange(points * turns))


def noise(motion: Motion, seed: int = 1, **params: float) -> Array:
    """Error (n,) of a simulated sweep in units of the noise's RMS."""
    chain = Chain().with_effect("noise", rms_deg=np.degrees(RMS_RAD), **params)
    sweep = chain.simulate(motion, seed=seed)
    return wrap(np.radians(sweep.measured_deg) - motion.shaft_rad) / RMS_RAD


def density(omega: Array, params: dict[str, float]) -> Array:
    """Spectral density over angular frequency (0 to pi a reading), of mean 1."""
    share = params.get("correlated_share", 1.0)
    phi, exponent = params.get("correlation", 0.0), params.get("flicker_exponent", 0.0)
    place, quality = params.get("ringing_per_reading", 0.0), params.get("ringing_quality", 1.0)
    fall = np.exp(-TAU * place / quality) if place else 0.0
    ring = np.sqrt(fall) * np.exp(1j * TAU * place)

    def shape(at: Array) -> Array:
        turned = np.exp(1j * at)
        return np.asarray(
            np.abs((1.0 - phi * turned) * (1.0 - 2.0 * ring.real * turned + fall * turned**2)) ** -2.0 * at**-exponent
        )

    middle = np.pi * (np.arange(200_000) + 0.5) / 200_000
    return np.asarray(1.0 - share + share * shape(omega) / np.mean(shape(middle)))


SPECTRA: tuple[dict[str, float], ...] = (
    {},
    {"correlation": 0.8},
    {"correlation": 0.95, "correlated_share": 0.4},
    {"flicker_exponent": 0.6},
    {"flicker_exponent": 0.8, "correlated_share": 0.5},
    {"flicker_exponent": 0.5, "correlation": 0.6},
    {"ringing_per_reading": 0.1, "ringing_quality": 6.0, "correlated_share": 0.7},
)


def bands(values: Array) -> tuple[list[Array], Array]:
    """Fourier frequencies of twelve bands, each twice as wide as the one below, and the mean power in each."""
    power = np.abs(np.fft.rfft(values * np.hanning(values.size))) ** 2 / np.sum(np.hanning(values.size) ** 2)
    edges = np.unique(np.geomspace(16, values.size // 2, 13).astype(int))
    parts = [np.arange(low, high) for low, high in itertools.pairwise(edges)]
    return [TAU * part / values.size for part in parts], np.array([np.mean(power[part]) for part in parts])


@pytest.mark.parametrize("params", SPECTRA, ids=str)
@pytest.mark.parametrize("rotating", [0.0, 1.0])
def test_spectrum_is_the_stated_one(params: dict[str, float], rotating: float) -> None:
    """Of the angle in the rotating frame; of a channel in its own.

    A band's power is known to sqrt(1.9 / its frequencies) by a Hann window's: five of these, and 5 % for the slope of
    1/f noise within the lowest bands.
    """
    motion = steady(points=360, turns=90)
    if rotating:
        values = noise(motion, rotating_frame=1.0, **params)
    else:
        chain = Chain().with_effect("noise", rms_deg=np.degrees(RMS_RAD), **params)
        values = (chain.channels(motion, np.random.default_rng(1))[0] - np.cos(motion.shaft_rad)) / RMS_RAD
    omega, power = bands(values)
    expected = np.array([np.mean(density(part, params)) for part in omega])
    slack = 5.0 * np.sqrt(1.9 / np.array([part.size for part in omega])) + 0.05
    assert np.all(np.abs(power / expected - 1.0) < slack)


def test_slow_noise_of_a_channel_is_no_slow_noise_of_the_angle() -> None:
    """Why there are two frames: on a turning shaft a channel's noise moves by one order of the turn, and half of it
    each way."""
    motion = steady(points=24, turns=1500)
    params = {"correlation": 0.97}
    orders = TAU / 24
    slow = {frame: bands(noise(motion, rotating_frame=frame, **params))[1][0] for frame in (0.0, 1.0)}
    omega = bands(motion.shaft_rad)[0][0]
    expected = np.mean(density(orders - omega, params) + density(orders + omega, params)) / 2.0
    # The lowest band has 12 frequencies: the power of a Hann window's is known to 40 %.
    assert slow[0.0] == pytest.approx(expected, rel=1.5)
    assert slow[1.0] > 20.0 * slow[0.0]


@pytest.mark.parametrize("rotating", [0.0, 1.0])
@pytest.mark.parametrize("dof", [3.0, 4.0, 10.0])
def test_tails_are_those_of_student(dof: float, rotating: float) -> None:
    """Quantiles of white noise within five of their standard deviations, sqrt(p (1 - p) / n) over the density there."""
    motion = steady(points=360, turns=100)
    if rotating:
        values = noise(motion, inverse_dof=1.0 / dof, rotating_frame=1.0)
    else:
        chain = Chain().with_effect("noise", rms_deg=np.degrees(RMS_RAD), inverse_dof=1.0 / dof)
        values = (chain.channels(motion, np.random.default_rng(1))[0] - np.cos(motion.shaft_rad)) / RMS_RAD
    unit = np.sqrt((dof - 2.0) / dof)
    for share in (0.9, 0.99, 0.999):
        quantile = float(student.ppf(share, dof))
        deviation = np.sqrt(share * (1.0 - share) / values.size) / student.pdf(quantile, dof)
        assert np.quantile(values, share) / unit == pytest.approx(quantile, abs=5.0 * deviation)


SCALES = (
    ("backward_percent", 80.0, lambda m, a: np.where(m.direction < 0.0, 1.8, 1.0)),
    ("percent_per_K", 2.0, lambda m, a: 1.02 ** (m.temperature_c - 25.0)),
    ("percent_per_rpm", 0.3, lambda m, a: 1.003 ** (np.abs(m.speed_rad_s) * 60.0 / TAU)),
    ("angle_percent", 150.0, lambda m, a: 2.5 ** np.cos(a - np.radians(40.0))),
)


@pytest.mark.parametrize("rotating", [0.0, 1.0])
@pytest.mark.parametrize(("name", "value", "expected"), SCALES, ids=lambda part: part if isinstance(part, str) else "")
def test_scale_follows_the_condition(name: str, value: float, expected: Any, rotating: float) -> None:
    """In eighths of the readings, loudest to quietest: a standard deviation of 1800 is known to 1.7 %, five of these.

    Within an eighth the scale changes by a fifth at most, of which the mean square is taken.
    """
    motion = full_motion(points=900)
    phase = {"angle_phase_deg": 40.0} if name == "angle_percent" else {}
    values = noise(motion, rotating_frame=rotating, **{name: value}, **phase)
    scale = expected(motion, motion.shaft_rad)
    for part in np.array_split(np.argsort(scale, kind="stable"), 8):
        assert np.std(values[part]) == pytest.approx(np.sqrt(np.mean(scale[part] ** 2)), rel=0.085)


def test_white_gaussian_noise_is_what_the_generator_draws() -> None:
    """The sweeps of a twin file stay what they are, byte for byte, whatever stands at null beside its parameters."""
    motion = steady(points=90, turns=2)
    null = Chain().with_effect("noise", rms_deg=0.1).values["noise"]
    chain = Chain().with_values({"noise": {"rms_deg": 0.1}})
    drawn = np.radians(0.1) * np.random.default_rng(3).standard_normal((2, len(motion)))
    expected = np.stack([np.cos(motion.shaft_rad), np.sin(motion.shaft_rad)]) + drawn
    for one in (chain, chain.with_values({"noise": null})):
        assert one.channels(motion, np.random.default_rng(3)).tobytes() == expected.tobytes()


def test_first_order_noise_is_drawn_by_its_recursion() -> None:
    """As above: each channel's white share first, then the innovations of its correlated share."""
    motion, phi, share = steady(points=60, turns=2), 0.7, 0.3
    rng = np.random.default_rng(4)
    white, steps = rng.standard_normal((2, 120)), rng.standard_normal((2, 120))
    coloured = steps.copy()
    for row in range(1, 120):
        coloured[:, row] = phi * coloured[:, row - 1] + np.sqrt(1.0 - phi**2) * steps[:, row]
    expected = np.sqrt(1.0 - share) * white + np.sqrt(share) * coloured
    chain = Chain().with_effect("noise", rms_deg=1.0, correlation=phi, correlated_share=share)
    ideal = np.stack([np.cos(motion.shaft_rad), np.sin(motion.shaft_rad)])
    drawn = chain.channels(motion, np.random.default_rng(4)) - ideal
    np.testing.assert_allclose(drawn / np.radians(1.0), expected, rtol=0.0, atol=1e-12)


def test_a_batch_has_a_size_each_and_one_shape() -> None:
    motion = steady(points=90, turns=2)
    values = {"rms_deg": np.array([0.1, 0.2]), "flicker_exponent": 1.0, "rotating_frame": 1.0, "inverse_dof": 0.2}
    together = Chain().with_values({"noise": values}).channels(motion, np.random.default_rng(1))
    assert together.shape == (2, 2, 180)


@pytest.mark.parametrize(
    "one",
    [
        Noise(rms_rad=RMS_RAD),
        Noise(rms_rad=RMS_RAD, correlation=0.7, white_share=0.25),
        Noise(rms_rad=RMS_RAD, flicker_exponent=1.2, dof=4.0),
        Noise(
            rms_rad=RMS_RAD, dof=5.0, scale=RowScale(backward_percent=30.0, angle_percent=20.0, angle_phase_deg=-70.0)
        ),
    ],
    ids=lambda one: one.label,
)
def test_a_description_survives_as_parameters_of_the_effect(one: Noise) -> None:
    values = parameters(one)
    back = described(Chain().with_effect("noise", **values).values["noise"])
    assert values["rms_deg"] == pytest.approx(np.degrees(RMS_RAD))
    assert (back.correlation, back.flicker_exponent, back.white_share) == (
        one.correlation,
        one.flicker_exponent,
        one.white_share,
    )
    assert back.dof == pytest.approx(one.dof)
    assert back.scale == one.scale


def test_labels_name_the_spectrum() -> None:
    assert Noise().label == "white"
    assert Noise(correlation=0.85, white_share=0.5).label == "AR(1) 0.85 + 50% white"
    assert Noise(flicker_exponent=1.0).label == "1/f^1"
