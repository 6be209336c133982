"""Stepwise: causes in the mean, added until nothing is left that stands out of the noise.

Shapes are put into noise that holds every quantile of the normal distribution, at two sizes: just below what stands out
among so many effects, and just above.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.marks.row_masks import without_rows
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual, with_settings
from twin.angles import Array

FINE = Made(points=180, bits=30)
Shape = Callable[[Fit], Array]


def harmonic(fit: Fit) -> Array:
    """A fifth order of the shaft."""
    return np.asarray(np.sin(5.0 * fit.observations.motion.shaft_rad + 1.0))


def saturated(fit: Fit) -> Array:
    """The fourth order that saturation leaves, locked to the sensor's axes."""
    return np.asarray(np.sin(4.0 * fit.linear.sensor_angle))


def without_name(fit: Fit) -> Array:
    """An order that belongs to no cause."""
    return np.asarray(np.sin(13.0 * fit.observations.motion.shaft_rad))


def nothing(fit: Fit) -> Array:
    return np.zeros(len(fit.observations))


@dataclass(frozen=True, kw_only=True)
class Case:
    """A shape of so many degrees, another beside it, and the causes that are found."""

    shape: Shape = nothing
    size_deg: float = 0.0
    beside: Shape = nothing
    beside_deg: float = 0.0
    found: tuple[str, ...] = ()


BOTH = ("unnamed_order", "magnet_harmonic")
CASES = {
    "noise alone": Case(),
    "harmonic, too weak": Case(shape=harmonic, size_deg=0.0085),
    "harmonic, strong enough": Case(shape=harmonic, size_deg=0.0095, found=("magnet_harmonic",)),
    "saturation, too weak": Case(shape=saturated, size_deg=0.01),
    "saturation, strong enough": Case(shape=saturated, size_deg=0.011, found=("saturation",)),
    # e^6 to one against a shape without a name.
    "without a name, too weak": Case(shape=without_name, size_deg=0.011),
    "without a name, strong enough": Case(shape=without_name, size_deg=0.013, found=("unnamed_order",)),
    "beside a shape without a name, too weak": Case(
        shape=harmonic, size_deg=0.0105, beside=without_name, beside_deg=0.03, found=BOTH[:1]
    ),
    "beside a shape without a name, strong enough": Case(
        shape=harmonic, size_deg=0.016, beside=without_name, beside_deg=0.03, found=BOTH
    ),
    "beside a named cause": Case(
        shape=harmonic, size_deg=0.0105, beside=saturated, beside_deg=0.03, found=("saturation", "magnet_harmonic")
    ),
}


def handed(case: Case, made: Made = FINE) -> State:
    state = before(stepwise, made)
    residual = noise(len(state.sweep))
    for shape, size_deg in ((case.shape, case.size_deg), (case.beside, case.beside_deg)):
        residual += np.radians(size_deg) * shape(state.fit)
    return with_residual(state, residual)


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_what_stands_out_is_found(case: Case) -> None:
    state = handed(case)
    after = stepwise(state)
    assert set(after.keys) == set(case.found)
    assert set(after.fit.chain.values) == {*state.fit.chain.values, *case.found}
    # The error model alone, from which the search set out.
    assert after.baseline is state.fit
    assert after.findings == ()


@pytest.mark.parametrize(
    ("made", "looked_at"),
    [(FINE, 15), (replace(FINE, back=True), 20), (replace(FINE, left_out=("time_s", "turn", "direction")), 12)],
)
def test_only_effects_that_the_recording_can_show_are_looked_at(made: Made, looked_at: int) -> None:
    """One turn shows those of the angle; both ways show what turns with the direction, time stamps what drifts."""
    assert stepwise(handed(Case(), made)).looked_at == looked_at


@pytest.mark.parametrize(("factor", "found"), [(0.95, ()), (1.1, ("magnet_harmonic",))])
def test_below_a_files_last_digit_nothing_is_searched(factor: float, found: tuple[str, ...]) -> None:
    """A clear shape whose RMS lies on either side of the limit."""
    state = handed(Case(shape=harmonic, size_deg=0.1))
    residual = state.fit.residual[0]
    rms = np.radians(6e-5 * factor)
    assert stepwise(with_residual(state, residual * rms / np.sqrt(np.mean(residual**2)))).keys == found


def test_no_more_causes_are_added_than_may_be() -> None:
    state = handed(Case(shape=harmonic, size_deg=0.05, beside=saturated, beside_deg=0.1))
    assert set(stepwise(state).keys) == {"magnet_harmonic", "saturation"}
    assert stepwise(with_settings(state, most_causes=1)).keys == ("saturation",)


def test_causes_that_are_held_already_are_open_to_revision() -> None:
    """A second search sets out from them: what is idle now goes, and the error model is still the one before any."""
    found = stepwise(handed(Case(shape=harmonic, size_deg=0.05, beside=saturated, beside_deg=0.05)))
    assert set(found.keys) == {"magnet_harmonic", "saturation"}
    fit = found.fit
    gone = fit.chain.readings(fit.linear.motion) - fit.chain.without("magnet_harmonic").readings(fit.linear.motion)
    after = stepwise(with_residual(found, noise(len(gone)) - gone))
    assert after.keys == ("saturation",)
    assert after.baseline is found.baseline


def test_rows_that_another_effect_has_claimed_stay_out() -> None:
    state = handed(Case(shape=harmonic, size_deg=0.05))
    touched = np.isin(np.arange(len(state.sweep)), (20, 21, 90))
    residual = np.where(touched, np.radians(0.07), state.fit.residual[0])
    state = with_residual(state, residual).with_(touched=touched)
    after = stepwise(state.with_(without_rows(state.fit, touched)))
    assert after.keys == ("magnet_harmonic",)
    assert tuple(np.flatnonzero(~after.fit.observations.usable)) == (20, 21, 90)


@pytest.mark.parametrize("seed", range(4))
def test_noise_that_is_coloured_is_no_cause(seed: int) -> None:
    """It is taken for what it is; by the policy one sweep in a hundred would be given a cause."""
    after = stepwise(before(stepwise, Made(points=72, turns=4, correlation=0.8, seed=seed)))
    assert after.keys == ()
    assert after.fit.weighting.member > 0


SLOW = {"points": 96, "turns": 2, "left_out": ("turn",)}
PAIRS = {
    # To each of the two the other is coloured noise, of which it stands out by itself no more than chance would.
    "coloured noise": Made(causes=(("index_slip", 0.065), ("bearing_wobble", 0.065)), seed=2, **SLOW),
    # Four slow modes describe both nearly as well as these two do, with fewer causes.
    "a drift without a name": Made(
        causes=(("zero_drift", 0.4), ("bearing_wobble", 0.4)), seed=1, **{**SLOW, "points": 72}
    ),
    # Found first, the bit holds on to edges that the play had shifted; beside them the play is no gain.
    "edges that were shifted": Made(
        causes=(("adc_stuck_bit", 0.12), ("backlash", 0.15)), points=180, back=True, seed=4
    ),
}


@pytest.mark.parametrize("made", PAIRS.values(), ids=PAIRS)
def test_two_causes_that_pass_for_something_else_are_found(made: Made) -> None:
    assert set(stepwise(before(stepwise, made)).keys) == {name for name, _ in made.causes}


def test_what_the_radius_shows_is_taken_for_causes_first() -> None:
    """A search in which it may be noise of its own is made only where causes leave some of it unexplained."""
    made = Made(causes=(("saturation", 0.1),), points=120, turns=2, bits=30, channels=True)
    after = stepwise(before(stepwise, made))
    assert after.keys == ("saturation",)
    assert after.fit.weighting.radius_trusted
