"""The joint fit against scipy's least squares, which is handed the whole chain and differentiates it by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from scipy.fft import dct
from scipy.optimize import least_squares

from diagnosis.discovery.fitting import joint_fit
from diagnosis.discovery.fitting.bounded_step import eased
from diagnosis.discovery.fitting.free_parameters import BASELINE, Free, free_of
from diagnosis.discovery.fitting.joint_fit import SMALL_GAIN, Fit, Weighting, cost_of, evaluate, solve
from diagnosis.discovery.fitting.linearised_chain import Linear
from diagnosis.discovery.fitting.noise_family import noise_family
from diagnosis.discovery.fitting.observations import collect
from diagnosis.discovery.settings import DiscoverySettings
from scenarios.commands.protocol import Protocol
from tests.twin.test_mirror import MISPLACED
from twin.angles import Array, wrap
from twin.catalogue import find
from twin.chain import Chain
from twin.effect import Effect
from twin.magnet.assembly import Assembly
from twin.magnet.magnet_misalignment import TOLERANCE_DEG

NOISE_DEG = 0.02
AWAY = 3.0
"""Standard deviations, in each parameter, from which the fits set out."""
DEVICE = {
    "offset": {"x_percent": 0.8, "y_percent": -0.5},
    "gain_mismatch": {"ratio": 1.01},
    "phase": {"beta_deg": 0.3},
    "quadratic_nonlinearity": {"q_percent": 0.3},
    "zero": {"zero_deg": 30.0},
}


@dataclass(frozen=True, kw_only=True)
class Case:
    """Causes beside the device's own, whether channels are recorded, and the member of the noise family in force.

    ``neglected``: slope over the shaft of the reference's error, which the linearised chain leaves out.
    """

    causes: dict[str, dict[str, float]]
    channels: bool = False
    member: int = 0
    magnet: Assembly | None = None
    neglected: float = 0.0


CASES = {
    "baseline": Case(causes={}),
    "baseline with radius": Case(causes={}, channels=True),
    "baseline in coloured noise": Case(causes={}, member=3),
    "behind a misplaced magnet": Case(causes={}, channels=True, magnet=MISPLACED),
    "saturation and hysteresis": Case(
        causes={"saturation": {"k_percent": 0.8}, "hysteresis": {"lag_deg": 0.1, "memory_deg": 12.0}}
    ),
    "eccentric reference": Case(
        causes={"reference_eccentricity": {"amplitude_deg": 0.3, "phase_deg": 40.0}},
        channels=True,
        neglected=float(np.radians(0.3)),
    ),
    "tone of the mains": Case(
        causes={"mains_pickup": {"frequency_Hz": 50.1, "x_percent": 0.4, "y_percent": 0.2, "phase_deg": 30.0}},
        channels=True,
    ),
    "drift and bump": Case(
        causes={
            "zero_drift": {"amplitude_deg": 0.4, "time_constant_s": 2.0},
            "unnamed_bump": {"centre_deg": 100.0, "width_deg": 10.0, "height_deg": 0.15},
        }
    ),
    "clipping": Case(causes={"clipping": {"level_percent": 99.0}}, channels=True),
}


def started(case: Case) -> tuple[Fit, Array]:
    """A fit that sets out from a chain off the truth, and the standard deviations (P,) at the truth."""
    motion = Protocol(turns=2, points=180, both_directions=True, speeds_rpm=(300.0,), channels=case.channels).motion()
    chain = Chain(sensor_sense=-1, magnet=case.magnet)
    for key, params in {**DEVICE, **case.causes}.items():
        chain = chain.with_effect(key, **params)
    observations = collect(chain.with_effect("noise", rms_deg=NOISE_DEG).simulate(motion, seed=3))
    assert observations.usable.all()
    free = [*BASELINE]
    for key in case.causes:
        free += free_of(find(key), key, turns=1, channels=case.channels)
    weighting = Weighting(
        noise_family(observations.lengths, DiscoverySettings().colour_log_odds),
        member=case.member,
        radius_member=case.member,
        radius_weight=1.0 if case.channels else 0.0,
    )
    true = evaluate(chain, tuple(free), observations, weighting)
    deviation = np.sqrt(np.diag(true.covariance()))
    off = AWAY * np.random.default_rng(5).choice([-1.0, 1.0], size=len(free))
    return evaluate(at(true, values_of(true) + off * deviation), true.free, observations, weighting), deviation


def values_of(fit: Fit) -> Array:
    """Values (P,) of the free parameters."""
    return np.array([float(fit.chain.values[free.key][free.name]) for free in fit.free])


def at(fit: Fit, values: Array) -> Chain:
    """The fit's chain with its free parameters at these values (P,)."""
    found: dict[str, dict[str, Any]] = {key: dict(params) for key, params in fit.chain.values.items()}
    for free, value in zip(fit.free, values, strict=True):
        found[free.key][free.name] = float(value)
    return replace(fit.chain, values=found)


def misfit(fit: Fit, values: Array) -> Array:
    """Whitened residuals of angle and radius, from the chain's own readings and channels."""
    observations, chain = fit.observations, at(fit, values)
    shaft = chain.shaft(observations.motion)
    parts = [wrap(observations.measured - chain.readings(shaft))]
    if observations.log_radius is not None:
        x, y = chain.channels(shaft)
        radius = observations.log_radius - np.log(np.hypot(x, y))
        parts.append(radius - np.mean(radius))
    root = 1.0 / np.sqrt(fit.weighting.family.spectra[fit.weighting.member])
    white = [root * dct(part, type=2, norm="ortho") / np.radians(NOISE_DEG) for part in parts]
    return np.concatenate([*white, [pull(free, value) for free, value in zip(fit.free, values, strict=True)]])


def pull(free: Free, value: float) -> float:
    """How far a parameter is from what is likely beforehand, in standard deviations of that; 0 where nothing is."""
    param = find(free.key).params[free.name]
    return 0.0 if param.prior_mean is None else (value - param.prior_mean) / param.prior_sd


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_the_optimum_is_that_of_least_squares(case: Case) -> None:
    """The solver ends where a step gains less than a thousandth in chi-square: its root of a deviation from the end.

    Where the reference errs, a share of the derivative is left out, and with it that share of a deviation.
    """
    fit, deviation = started(case)
    found, start = values_of(solve(fit)), values_of(fit)
    oracle = least_squares(
        lambda u: misfit(fit, start + u * deviation),
        np.zeros(len(start)),
        jac="3-point",
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-12,
    )
    away = np.abs((found - start) / deviation - oracle.x)
    assert np.max(np.abs(oracle.x)) > 0.5 * AWAY
    assert np.max(away) < np.sqrt(SMALL_GAIN) + case.neglected


def test_a_step_taken_back_costs_no_derivatives() -> None:
    """Only a fit that a search goes on from is asked for them."""
    fit, _ = started(CASES["saturation and hysteresis"])
    trial = evaluate(fit.chain, fit.free, fit.observations, fit.weighting)
    assert cost_of(trial) == pytest.approx(float(np.sum(trial.whitened()[0] ** 2)))
    trial = evaluate(fit.chain, fit.free, fit.observations, fit.weighting)
    cost_of(trial)
    assert "_kept" not in vars(trial.columns)
    assert "_points" not in vars(trial.linear)


def test_only_those_columns_are_found_that_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    fit, _ = started(CASES["saturation and hysteresis"])
    fit = evaluate(fit.chain, fit.free, fit.observations, fit.weighting)
    found: list[str] = []
    derivatives = Linear.derivatives

    def counted(linear: Linear, key: str, effect: Effect, moved: Sequence[tuple[str, int | None]]) -> Array:
        found.append(key)
        return derivatives(linear, key, effect, moved)

    monkeypatch.setattr(Linear, "derivatives", counted)
    place = next(place for place, free in enumerate(fit.free) if free.key == "saturation")
    (one,) = fit.whitened_columns([place])
    assert found == ["saturation"]
    _, every = fit.whitened()
    assert sorted(found) == sorted({free.key for free in fit.free})
    assert np.array_equal(one, every[place])


def test_a_step_that_promises_nothing_is_not_tried_shorter(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no step is any good, a fit at its optimum gives up after one, a fit far from it after six."""
    fit, _ = started(CASES["saturation and hysteresis"])
    optimum = solve(solve(fit))
    tried: list[Fit] = []

    def worse(*given: Any) -> Fit:
        tried.append(evaluate(*given))
        return replace(tried[-1], cosine_residual=1e3 * tried[-1].cosine_residual)

    monkeypatch.setattr(joint_fit, "evaluate", worse)
    assert solve(optimum) is optimum
    assert len(tried) == 1
    assert solve(fit) is fit
    assert len(tried) == 1 + 6


def test_what_is_likely_beforehand_pulls_as_one_more_reading_would() -> None:
    """A tilt of twice its standard deviation is two RMS of the residual off; a direction may be any."""
    tilted = find("magnet_misalignment").null() | {
        "product_mm2": 0.05,
        "sensor_tilt_x_deg": 2.0 * TOLERANCE_DEG,
        "direction_deg": 40.0,
    }
    fit, _ = started(Case(causes={"magnet_misalignment": tilted}, channels=True))
    fit = evaluate(fit.chain.with_effect("magnet_misalignment", **tilted), fit.free, fit.observations, fit.weighting)
    held = [free.name for free, strength in zip(fit.free, fit.strengths, strict=True) if strength > 0.0]
    pulls = dict(zip(held, fit.prior_residual, strict=True))
    rms = float(np.sqrt(np.mean(fit.residual[0] ** 2)))
    assert pulls["sensor_tilt_x_deg"] == pytest.approx(-2.0 * rms)
    assert pulls["direction_deg"] == 0.0
    assert np.count_nonzero(fit.prior_jacobian) == len(held)


def test_damping_is_eased_by_a_third_at_most_whatever_a_step_gained() -> None:
    # At half of what was expected the damping stays.
    assert [eased(share) for share in (0.5, 1.0, 1e200)] == [1.0, 1.0 / 3.0, 1.0 / 3.0]


def test_a_strength_without_a_phase_ends_at_its_bound() -> None:
    """A curve that runs ahead of the field is no negative saturation."""
    fit, _ = started(Case(causes={"saturation": {"k_percent": 1.0}}))
    shaft = fit.chain.shaft(fit.observations.motion)
    ahead = fit.chain.with_values({"saturation": {"k_percent": -1.0}}).readings(shaft)
    fit = replace(fit, observations=replace(fit.observations, measured=ahead))
    found = solve(evaluate(fit.chain, fit.free, fit.observations, fit.weighting))
    assert found.chain.values["saturation"]["k_percent"] == 0.0
