"""Observe: rows that count as independent angles, and the grid on which the readings lie."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.initial_fit import initial_fit
from diagnosis.discovery.stages.observe import observe
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, start_of, sweep_of
from twin.chain import Chain
from twin.sweep import Sweep

NOISE_DEG = 0.02


@dataclass(frozen=True, kw_only=True)
class Case:
    """A sweep, and what is seen of it: rows, those set aside, bits of the word, the scatter of repeats [deg]."""

    made: Made
    rows: int
    aside: tuple[int, ...] = ()
    bits: int | None = None
    repeat_deg: float | None = None
    radius: bool = False


CASES = {
    "one turn": Case(made=Made(bits=30, points=72), rows=72),
    "ten readings at each angle": Case(made=Made(bits=30, points=60, repeats=10), rows=60, repeat_deg=NOISE_DEG),
    "direction recorded": Case(made=Made(bits=30, points=72, back=True), rows=144),
    "direction inferred": Case(
        made=Made(bits=30, points=72, back=True, left_out=("direction", "turn")), rows=144, aside=(72, 73)
    ),
    "channels": Case(made=Made(bits=30, points=72, channels=True), rows=72, radius=True),
    "words of 12 bits": Case(made=Made(bits=12, points=72), rows=72, bits=12),
    "words of 14 bits": Case(made=Made(bits=14, points=72), rows=72, bits=14),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_what_is_seen(case: Case) -> None:
    state = observe(start_of(case.made))
    observations = state.fit.observations
    assert len(observations) == case.rows
    assert tuple(np.flatnonzero(~observations.usable)) == case.aside
    assert state.bits == case.bits
    assert state.step == (2.0 * np.pi / 2.0**case.bits if case.bits else 0.0)
    assert (observations.observables == 2) == case.radius
    assert state.fit.weighting.radius_weight == float(case.radius)
    assert state.fit.free == ()
    assert state.fit.settings is state.settings
    if case.repeat_deg is None:
        assert observations.repeat_rms is None
    else:
        # A standard deviation of n readings, a degree of freedom lost at each angle: five of its own deviations.
        dof = len(sweep_of(case.made)) - case.rows
        assert observations.repeat_rms == pytest.approx(np.radians(case.repeat_deg), rel=5.0 / np.sqrt(2.0 * dof))


@pytest.mark.parametrize(("missing", "bits"), [(0, 12), (1, None)])
def test_few_words_say_nothing_of_the_grid(missing: int, bits: int | None) -> None:
    """As many words as the limit, on a grid of 12 bits, and one fewer."""
    words = 40 - missing
    reference = np.arange(80) * 4.5
    # Odd words among them: even ones alone would lie on a grid of 11 bits.
    measured = ((np.arange(80) % words) * 51 + 1) * 360.0 / 2**12
    sweep = Sweep(reference_deg=reference, measured_deg=measured)
    assert observe(State.of(sweep, Chain())).bits == bits


def test_suspects_stay_out_of_the_first_fit() -> None:
    """A reading half a turn off moves the first fit not at all where it is suspected, and by degrees where not."""
    made = Made(points=72, bits=30)
    plain = start_of(made, DiscoverySettings())
    measured_deg = plain.sweep.measured_deg.copy()
    measured_deg[10] += 180.0
    flipped = plain.with_(sweep=replace(plain.sweep, measured_deg=measured_deg))
    suspects = np.arange(len(plain.sweep)) == 10
    first = {
        name: initial_fit(observe(state)).fit.linear.angle
        for name, state in {
            "as it was": plain.with_(suspects=suspects),
            "suspected": flipped.with_(suspects=suspects),
            "trusted": flipped,
        }.items()
    }
    assert np.array_equal(first["suspected"], first["as it was"])
    # One reading of 72 that is off by pi moves a mean by pi / 72, which is 2.5 deg.
    assert np.degrees(np.max(np.abs(first["trusted"] - first["as it was"]))) > 1.0
