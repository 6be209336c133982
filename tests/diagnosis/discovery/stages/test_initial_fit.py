"""Initial fit: the paper's error model with all its parameters free, or a given twin with its zeros alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.free_parameters import BASELINE, ZERO_ANGLE, Free
from diagnosis.discovery.stages.initial_fit import initial_fit
from diagnosis.discovery.stages.observe import observe
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, bench_of, planted_of, start_of
from twin.chain import Chain


@pytest.mark.parametrize(
    "made",
    [
        Made(points=180),
        Made(points=180, sense=-1),
        Made(points=180, output_sense=-1),
        Made(points=180, channels=True),
        Made(points=180, quadratic=0.0),
    ],
    ids=["as it is", "sensor counts back", "output counts back", "channels", "no quadratic term"],
)
def test_the_error_model_is_recovered(made: Made) -> None:
    """Within five standard deviations of the fit's own covariance, from a chain that knows the zero alone."""
    fit = initial_fit(before(initial_fit, made)).fit
    assert fit.free == BASELINE
    true = bench_of(made).baseline
    expected = {
        "zero_deg": true.zero_deg,
        "x_percent": 100.0 * true.offset_x,
        "y_percent": 100.0 * true.offset_y,
        "ratio": true.amplitude_y / true.amplitude_x,
        "beta_deg": true.phase_deg,
        "q_percent": 100.0 * true.quadratic,
    }
    deviation = dict(zip((free.name for free in fit.free), np.sqrt(np.diag(fit.covariance())), strict=True))
    found = {free.name: float(fit.chain.values[free.key][free.name]) for free in fit.free}
    assert {
        name: abs(found[name] - value) < 5.0 * deviation[name] for name, value in expected.items()
    } == dict.fromkeys(expected, True)
    # And each is known to a part of what it may be: none of them is left where it began for want of information.
    assert max(deviation.values()) < 0.1


@dataclass(frozen=True, kw_only=True)
class Given:
    """A sweep, the causes of the twin that it is held against, and what that leaves [deg]."""

    made: Made
    known: Mapping[str, Mapping[str, float]]
    left_deg: float
    per_turn: int = 0


_CAUSES = (("saturation", 0.1), ("reference_rezero", 0.1))
GIVEN = {
    "all known": Given(made=Made(causes=_CAUSES[:1]), known={"saturation": {}}, left_deg=0.02),
    # c - k c^3 leaves an order 4 of the strength's amplitude, and an order 2 that the gain ratio is not free to take.
    "saturation missing": Given(made=Made(causes=_CAUSES[:1]), known={}, left_deg=0.1 / np.sqrt(2.0)),
    "zeros of the turns": Given(
        made=Made(causes=_CAUSES, turns=3, points=60),
        known={"saturation": {}, "reference_rezero": {"spread_deg": 0.3}},
        left_deg=0.02,
        per_turn=3,
    ),
}


def state_of(case: Given) -> State:
    """What the stage is handed: a twin whose zero is that of another mounting."""
    true = bench_of(case.made).baseline
    twin = (
        Chain()
        .with_effect("zero", zero_deg=-100.0)
        .with_effect("offset", x_percent=100.0 * true.offset_x, y_percent=100.0 * true.offset_y)
        .with_effect("gain_mismatch", ratio=true.amplitude_y)
        .with_effect("phase", beta_deg=true.phase_deg)
        .with_effect("quadratic_nonlinearity", q_percent=100.0 * true.quadratic)
    )
    planted = {one.name: one.parameters for one in planted_of(case.made)}
    for name, params in case.known.items():
        twin = twin.with_effect(name, **(params or {"k_percent": planted[name]["k_percent"]}))
    return observe(replace(start_of(case.made), start=twin, given=twin))


@pytest.mark.parametrize("case", GIVEN.values(), ids=GIVEN)
def test_of_a_given_twin_the_zeros_alone_are_free(case: Given) -> None:
    """What is left is known to 1/sqrt(2n) of itself: five of these, and a tenth for what the zero takes of it."""
    state = state_of(case)
    fit = initial_fit(state).fit
    zeros = tuple(Free("reference_rezero", "zeros_deg", turn) for turn in range(case.per_turn))
    assert fit.free == (ZERO_ANGLE, *zeros)
    for key in ("offset", "gain_mismatch", "phase", "quadratic_nonlinearity", *case.known):
        if key != "reference_rezero":
            assert fit.chain.values[key] == state.start.values[key]
    left_deg = float(np.degrees(np.sqrt(np.mean(fit.residual[0] ** 2))))
    assert left_deg == pytest.approx(case.left_deg, rel=5.0 / np.sqrt(2.0 * fit.rows) + 0.1)
    if case.per_turn:
        hidden = {one.name: one for one in planted_of(case.made)}["reference_rezero"].hidden["zero_deg"]
        found = fit.chain.values["reference_rezero"]["zeros_deg"]
        # Each turn's zero is a mean of its readings: five of their deviations.
        assert np.max(np.abs(found - np.mean(found) - hidden)) < 5.0 * 0.02 / np.sqrt(case.made.points)
