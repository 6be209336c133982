"""The menu plans what it says, and the separation is what simulated readings then show."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.discovery.fitting import joint_fit
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.further import power
from diagnosis.discovery.further.measurements import FINEST_DEG, MENU
from diagnosis.discovery.further.power import Option, advice, best, expected, separation_sigma
from diagnosis.discovery.result import Discovery
from scenarios.commands.protocol import Protocol
from twin.chain import Chain
from twin.motion import Motion
from twin.recordings import Setup

PLAN = {entry.name: entry.plan for entry in MENU}
ONE_WAY = Protocol(turns=2, points=120, channels=False).motion()
BOTH_WAYS = Protocol(turns=1, points=72, both_directions=True, channels=False).motion()
SPINNING = Protocol(turns=3, points=120, speeds_rpm=(300.0,), channels=False).motion()
BRINGS = {
    "raw channels": "vx",
    "other direction": "both directions",
    "second speed": "two speeds",
    "second temperature": "two temperatures",
    "second mounting": "two mountings",
    "second air gap": "two air gaps",
}


def plan_of(name: str, motion: Motion) -> Motion:
    planned = PLAN[name](motion)
    assert planned is not None
    return planned


def farther(plan: Motion) -> Setup:
    assert plan.recordings is not None
    return plan.recordings.setups[-1]


@pytest.mark.parametrize("motion", [ONE_WAY, SPINNING], ids=["stopping", "spinning"])
@pytest.mark.parametrize(("name", "brings"), BRINGS.items())
def test_a_measurement_brings_what_it_is_named_for(name: str, brings: str, motion: Motion) -> None:
    assert brings not in motion.provides
    plan = plan_of(name, motion)
    assert brings in plan.provides
    assert PLAN[name](plan) is None
    assert ("vx" in plan.columns) == (name == "raw channels")


@pytest.mark.parametrize("name", [entry.name for entry in MENU])
@pytest.mark.parametrize("motion", [ONE_WAY, BOTH_WAYS, SPINNING], ids=["stopping", "both ways", "spinning"])
def test_a_planned_shaft_goes_on_from_where_it_stands_and_so_does_the_clock(name: str, motion: Motion) -> None:
    plan = PLAN[name](motion)
    if plan is None:
        return
    assert np.all(np.diff(plan.time_s) > 0.0)
    for part in plan.parts:
        assert np.max(np.abs(np.diff(part.shaft_rad))) < 1.5 * np.max(np.abs(np.diff(motion.shaft_rad)))
        begun = part.shaft_rad[: len(motion)] - part.shaft_rad[0]
        np.testing.assert_allclose(begun, motion.shaft_rad - motion.shaft_rad[0], atol=1e-12)
        moved = np.diff(part.shaft_rad) != 0.0
        np.testing.assert_array_equal(np.sign(np.diff(part.shaft_rad))[moved], part.direction[1:][moved])
        pace = np.diff(part.shaft_rad) / np.diff(part.time_s)
        steady = (part.speed_rad_s[1:] == part.speed_rad_s[:-1]) & (part.speed_rad_s[1:] != 0.0)
        within = steady & (np.diff(part.time_s) < 0.02)
        np.testing.assert_allclose(pace[within], part.speed_rad_s[1:][within], rtol=1e-6)


def test_points_after_a_reversal_are_as_dense_as_said() -> None:
    plan = plan_of("denser points after a reversal", BOTH_WAYS)
    steps = np.degrees(np.abs(np.diff(plan.shaft_rad[len(BOTH_WAYS) :])))
    assert np.min(steps) == pytest.approx(FINEST_DEG[0], rel=1e-6)
    assert np.max(steps) == pytest.approx(5.0, rel=0.01)
    assert PLAN["denser points after a reversal"](ONE_WAY) is None
    assert PLAN["denser points after a reversal"](SPINNING) is None


def test_a_second_air_gap_weakens_the_field() -> None:
    recordings = plan_of("second air gap", ONE_WAY).recordings
    assert recordings is not None
    near, far = recordings.setups
    assert (near.field, near.distance, near.air_gap_mm, far.air_gap_mm) == (1.0, 1.0, 1.5, 3.0)
    # Between a dipole's third power of the distance and none at all.
    assert far.distance**-3 < far.field < 1.0


def test_the_cheapest_that_is_enough_is_advised_and_a_poor_one_said_to_be() -> None:
    cheap, strong = Option("cheap", "do this", 6.0, 1), Option("strong", "do that", 60.0, 2)
    weak = Option("weak", "try this", 4.0, 1)
    assert best([strong, cheap]) == cheap
    assert best([weak, strong]) == strong
    assert advice([cheap, strong]) == "do this (6 sigma)"
    assert advice([weak]) == "try this (4.0 sigma, which may not be enough)"
    nothing = "no further measurement of the menu parts them"
    assert advice([replace(weak, sigma=2.9)]) == f"{nothing} (2.9 sigma at most)"
    assert advice([]) == nothing


def saturated(seed: int) -> Discovery:
    chain = (
        Chain()
        .with_effect("offset", x_percent=0.6, y_percent=-0.4)
        .with_effect("saturation", k_percent=0.6)
        .with_effect("noise", rms_deg=0.02)
    )
    return explain(chain.simulate(ONE_WAY, seed=seed)).discovery


def left(fit: Fit, sigma_rad: float) -> float:
    r, _ = fit.whitened()
    return float(r @ r) / sigma_rad**2


@pytest.mark.parametrize("name", ["raw channels", "more turns"])
def test_expected_separation_is_the_mean_of_what_noise_then_shows(name: str) -> None:
    """Thirty noisy sweeps of the plan: the mean gain of the truth over its rival within three of its own sigma."""
    found = saturated(3)
    (cause,) = found.causes
    assert "magnet_harmonic" in cause.rivals
    plan = plan_of(name, ONE_WAY)
    told = separation_sigma(found.fit, cause.rivals["magnet_harmonic"], plan)
    right, wrong = (expected(found.fit, rival, plan) for rival in (found.fit, cause.rivals["magnet_harmonic"]))
    rng, sigma, gains = np.random.default_rng(8), np.radians(0.02), []
    for _ in range(30):
        noisy = replace(
            right.observations,
            measured=right.observations.measured + sigma * rng.standard_normal(len(right.observations)),
            log_radius=None
            if right.observations.log_radius is None
            else right.observations.log_radius + sigma * rng.standard_normal(len(right.observations)),
        )
        fits = [solve(evaluate(part.chain, part.free, noisy, part.weighting)) for part in (right, wrong)]
        gains.append(left(fits[1], sigma) - left(fits[0], sigma))
    # Amplitude and phase take as much from the squares as the loss and its exponent; the fitted noise is known to 5 %.
    mean, spread = float(np.mean(gains)), 2.0 * max(told, 1.0) / np.sqrt(30.0)
    assert mean == pytest.approx(told**2, abs=3.0 * spread, rel=0.1)


def test_a_plan_is_solved_for_as_closely_as_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps of less than a hundredth are not taken: hundredths of what the noise is known to."""
    found = saturated(3)
    rival, plan = found.causes[0].rivals["magnet_harmonic"], plan_of("raw channels", ONE_WAY)
    runs: list[Fit] = []

    def counted(*given: Any) -> Fit:
        runs.append(evaluate(*given))
        return runs[-1]

    monkeypatch.setattr(joint_fit, "evaluate", counted)
    told, taken = separation_sigma(found.fit, rival, plan), len(runs)
    monkeypatch.setattr(power, "_LEAST_SHARE", 0.0)
    assert told == pytest.approx(separation_sigma(found.fit, rival, plan), rel=0.01)
    assert taken < len(runs) - taken


def test_a_second_air_gap_parts_saturation_from_a_harmonic_of_the_magnet() -> None:
    """By hand: fourth orders of a saturation shrink with its power of the field, the magnet's by its distance.

    The noise is the same in volts: in the weaker field an amplitude is known the less.
    """
    found = saturated(3)
    plan = plan_of("second air gap", ONE_WAY)
    far = farther(plan)
    values = found.fit.chain.values["saturation"]
    k = 0.01 * float(values["k_percent"])
    rows = len(ONE_WAY)
    apart = 0.25 * k * abs(far.field ** float(values["exponent"]) - far.distance**-4)
    # Amplitudes of two recordings of a common scale: each known to sqrt(2 / n), the difference shared between them.
    shared = far.field / np.hypot(1.0, far.field * far.distance**-4)
    by_hand = apart * shared * np.sqrt(rows / 2.0) / np.radians(0.02)
    told = separation_sigma(found.fit, found.causes[0].rivals["magnet_harmonic"], plan)
    assert told == pytest.approx(by_hand, rel=0.15)


def test_a_second_air_gap_parts_a_coercive_field_from_a_play() -> None:
    """By hand: a lag of the field is the coercive field's share of it, a play of the coupling stays what it is."""
    motion = Protocol(turns=1, points=72, both_directions=True, speeds_rpm=(60.0, 300.0), channels=False).motion()
    chain = Chain().with_effect("hysteresis", lag_deg=0.1, memory_deg=1.0).with_effect("noise", rms_deg=0.02)
    found = explain(chain.simulate(motion, seed=1)).discovery
    (cause,) = found.causes
    assert {cause.name, *cause.rivals} == {"hysteresis", "backlash"}
    grown = 1.0 / farther(plan_of("second air gap", motion)).field
    # Amplitudes (1, 1) of a play and (1, grown) of a lag, in two recordings of as many readings, of which the second is
    # louder by as much as the lag grows: (1, 1 / grown) and (1, 1) over the noise. What the lag leaves of the play is
    # the less of the two. The fitted noise is known to 1/sqrt(2 n), 4 %, the amplitude to 2 %.
    by_hand = 0.1 * (1.0 - 1.0 / grown) / np.sqrt(2.0) * np.sqrt(len(motion)) / 0.02
    (told,) = (option.sigma for option in cause.options if option.name == "second air gap")
    assert told == pytest.approx(by_hand, rel=3.0 * np.hypot(0.04, 0.02))


def test_what_is_told_apart_has_no_advice() -> None:
    chain = Chain().with_effect("hysteresis", lag_deg=0.15, memory_deg=15.0).with_effect("noise", rms_deg=0.01)
    dense = Protocol(turns=2, points=360, both_directions=True, channels=False).motion()
    (cause,) = explain(chain.simulate(dense, seed=1)).discovery.causes
    assert not cause.rivals
    assert cause.options == ()
