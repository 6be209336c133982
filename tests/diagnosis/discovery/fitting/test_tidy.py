"""Tidy: one of the equivalent ways to write a chain down, and the fit that goes with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.fitting.tidy import tidy
from diagnosis.discovery.search import likelihood_ratio
from diagnosis.discovery.search.likelihood_ratio import solve_tidy
from diagnosis.discovery.stages.stepwise import stepwise
from tests.diagnosis.discovery.searches import with_cause
from tests.diagnosis.discovery.sweeps import Made, before

HARMONIC = "magnet_harmonic"


@pytest.mark.parametrize(
    ("phase_deg", "amplitude_deg", "tidy_deg"),
    [(-0.1, 0.1, -0.1), (180.0, 0.1, 180.0), (-180.0, 0.1, 180.0), (370.0, 0.1, 10.0), (-30.0, -0.1, 150.0)],
)
def test_phases_are_within_half_a_turn_and_amplitudes_above_zero(
    phase_deg: float, amplitude_deg: float, tidy_deg: float
) -> None:
    chain = before(stepwise, Made(points=120)).fit.chain
    # A fit passes through bounds that a twin has.
    values = {"order": 3.0, "amplitude_deg": amplitude_deg, "phase_deg": phase_deg}
    chain = replace(chain, values={**chain.values, HARMONIC: values})
    found = tidy(chain).values[HARMONIC]
    # To the last digit: -0.1 + 180 - 180 is -0.0999...
    assert (found["phase_deg"], found["amplitude_deg"]) == (tidy_deg, abs(amplitude_deg))
    assert (tidy(chain) is chain) == (tidy_deg == phase_deg)


def test_a_fit_that_is_tidy_is_not_evaluated_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is the very fit that an evaluation of its chain gives."""
    state = with_cause(before(stepwise, Made(points=120)), HARMONIC, order=5.0, amplitude_deg=0.1)
    start = solve_tidy(state.fit)
    evaluated: list[object] = []

    def counted(*asked: object) -> object:
        evaluated.append(asked)
        return evaluate(*asked)  # type: ignore[arg-type]

    monkeypatch.setattr(likelihood_ratio, "evaluate", counted)
    found = likelihood_ratio.replace_chain(start, tidy(start.chain))
    assert evaluated == []
    monkeypatch.undo()
    again = evaluate(start.chain, start.free, start.observations, start.weighting)
    assert np.array_equal(found.strengths, again.strengths)
    assert np.array_equal(found.residual, again.residual)
    assert np.array_equal(found.jacobian, again.jacobian)
