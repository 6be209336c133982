"""Final fit: edges that noise has blurred get their slopes, and the baseline is fitted on the same observations."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate
from diagnosis.discovery.stages.final_fit import final_fit
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, truth_of

STUCK = Made(causes=(("adc_stuck_bit", 0.08),), points=180, turns=2)
ROUNDED = Made(causes=(("saturation", 0.08), ("output_quantisation", 0.08)), points=120, turns=2)
PLAIN = Made(causes=(("saturation", 0.08),), points=120)
GRID = "output_quantisation"


def cost(fit: Fit) -> float:
    residual, _ = fit.whitened()
    return float(residual @ residual)


def test_the_weight_of_a_stuck_bit_is_that_of_the_optimum() -> None:
    """Where edges count as slopes: it costs less there than where the search has stopped, and holds the true weight."""
    state = before(final_fit, STUCK)
    after = final_fit(state)
    assert (state.fit.weighting.slopes, after.fit.weighting.slopes) == (False, True)
    assert cost(after.fit) < cost(state.fit)
    deviation = dict(zip((f.name for f in after.fit.free), np.sqrt(np.diag(after.fit.covariance())), strict=True))
    found, true = after.fit.chain.values["adc_stuck_bit"], truth_of(STUCK, "adc_stuck_bit")
    assert abs(float(found["step_percent"]) - true["step_percent"]) < 5.0 * deviation["step_percent"]
    assert deviation["step_percent"] < 0.01 * true["step_percent"]


@dataclass(frozen=True, kw_only=True)
class Case:
    """A sweep, whether its grid is a cause, and whether the baseline is left with it."""

    made: Made
    cause: bool = False
    kept: bool = False


CASES = {
    "no grid": Case(made=PLAIN),
    "a grid that limits the readings": Case(made=ROUNDED, cause=True),
    "a grid that is no cause": Case(made=Made(causes=(("saturation", 0.08),), points=120, bits=14), kept=True),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_the_baseline_is_the_error_model_without_any_cause(case: Case) -> None:
    state = before(final_fit, case.made)
    assert (GRID in [finding.keys[0] for finding in state.findings]) == case.cause
    after = final_fit(state)
    assert after.fit is state.fit
    baseline = after.baseline
    assert baseline is not None
    assert (GRID in baseline.chain.values) == case.kept
    assert "saturation" not in baseline.chain.values
    assert state.baseline is not None
    assert baseline.free == state.baseline.free
    # Saturation of 0.08 deg leaves its order 4 of that amplitude.
    left_deg = np.degrees(np.sqrt(np.mean(baseline.residual[0] ** 2) - np.mean(after.fit.residual[0] ** 2)))
    assert left_deg == pytest.approx(0.08 / np.sqrt(2.0), rel=0.25)


def masked(state: State, rows: list[int]) -> State:
    """The state whose fit does without some rows, and weighs others by half."""
    usable, scale = np.ones(len(state.fit.observations), dtype=bool), np.ones(len(state.fit.observations))
    usable[rows], scale[60:] = False, 2.0
    fit = state.fit
    observations = replace(fit.observations.masked(usable), scale=scale)
    return state.with_(evaluate(fit.chain, fit.free, observations, replace(fit.weighting, member=2)))


def test_the_baseline_is_fitted_by_the_same_rows_and_weights() -> None:
    """So that what the causes gain is not a matter of rows that are left out."""
    state = masked(before(final_fit, PLAIN), [3, 4, 50])
    after = final_fit(state)
    assert after.baseline is not None
    assert after.baseline.observations is state.fit.observations
    assert after.baseline.weighting is state.fit.weighting
    # At its optimum: no parameter would move by a hundredth of its deviation.
    residual, jacobian = after.baseline.whitened()
    step = after.baseline.covariance() @ (jacobian @ residual) / (cost(after.baseline) / after.baseline.rows)
    assert np.max(np.abs(step) / np.sqrt(np.diag(after.baseline.covariance()))) < 0.01


def test_findings_that_are_no_stairs_leave_the_baseline_its_own() -> None:
    made = Made(causes=(("saturation", 0.08),), points=120, bits=14)
    state = before(final_fit, made).with_(findings=(Finding.among(1, "stale_frames", -20.0, gain=40.0),))
    baseline = final_fit(state).baseline
    assert baseline is not None
    assert GRID in baseline.chain.values
