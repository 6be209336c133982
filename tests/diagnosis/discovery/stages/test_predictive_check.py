"""Predictive check: the twin gets its noise and rare events, and its sweeps are held against the measured one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from diagnosis.discovery.marks.row_masks import scaled
from diagnosis.discovery.search.likelihood_ratio import drop
from diagnosis.discovery.stages.predictive_check import predictive_check
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before

SWEEPS = 199
NOISE_DEG = 0.02


@dataclass(frozen=True, kw_only=True)
class Case:
    """A sweep and what its twin simulates beside the mean; ``jitter_deg``: RMS of what is no noise of the twin's."""

    made: Made
    jitter_deg: float = 0.0
    correlation: float = 0.0
    random: tuple[str, str, float] | None = None


CASES = {
    "white": Case(made=Made(points=180)),
    "correlated": Case(made=Made(points=180, turns=2, correlation=0.8), correlation=0.8),
    "behind a grid": Case(made=Made(points=180, turns=2, bits=11)),
    "beside a jitter": Case(
        made=Made(causes=(("reference_jitter", 0.05),), points=180, turns=2),
        jitter_deg=0.05 / np.sqrt(2.0),
        random=("reference_jitter", "percent_rms", 100.0 * np.sqrt(2.0) * np.radians(0.05)),
    ),
    "with repeats": Case(
        made=Made(causes=(("stale_frames", 0.05),), points=180, turns=2),
        random=("stale_frames", "fraction_percent", 0.0),
    ),
    "with flipped bits": Case(
        made=Made(causes=(("bus_glitch", 0.05),), points=180, turns=2), random=("bus_glitch", "count", 2.0)
    ),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_the_twin_simulates_the_noise_and_the_rare_events(case: Case) -> None:
    """A variance is known to sqrt(2/n), by fewer readings where they run together; five of these.

    Where a jitter is taken out of it, the variance of both is known so well.
    """
    state = before(predictive_check, case.made)
    after = predictive_check(state)
    noise = after.fit.chain.values["noise"]
    runs = (1.0 + case.correlation) / (1.0 - case.correlation)
    slack = 5.0 * np.sqrt(2.0 * runs / state.fit.rows) * (NOISE_DEG**2 + case.jitter_deg**2)
    assert noise["rms_deg"] ** 2 == pytest.approx(NOISE_DEG**2, abs=slack)
    assert noise["correlation"] == pytest.approx(case.correlation, abs=0.15)
    if case.random is not None:
        key, name, true = case.random
        hidden = {one.keys[0]: len(one.rows) for one in state.causes}
        true = true or 100.0 * hidden[key] / len(state.sweep)
        assert after.fit.chain.values[key][name] == pytest.approx(true, rel=0.3)
    assert set(after.fit.chain.values) == {*state.fit.chain.values, "noise", *([case.random[0]] if case.random else [])}


def p_of(state: State) -> float:
    likeness = predictive_check(state).likeness
    assert likeness is not None
    return likeness.p


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_sweeps_of_the_right_twin_cannot_be_told_from_the_measured_one(case: Case) -> None:
    """By chance one in a hundred could; the draws are fixed. The p-value is a rank among them all."""
    p = p_of(before(predictive_check, case.made))
    assert p > 0.01
    assert p * (SWEEPS + 1) == pytest.approx(round(p * (SWEEPS + 1)))


def test_a_missing_cause_is_seen() -> None:
    state = before(predictive_check, Made(causes=(("saturation", 0.08),), points=180))
    lacking = state.with_(drop(state.fit, "saturation"), causes=(), keys=())
    assert p_of(lacking) == pytest.approx(1.0 / (SWEEPS + 1))


def test_uneven_noise_that_no_cause_carries_is_seen() -> None:
    state = before(predictive_check, Made(structure=("noise_burst", 0.1), points=180, turns=2))
    assert p_of(state) > 0.01
    assert p_of(state.with_(scaled(state.fit, np.ones(state.fit.rows)))) == pytest.approx(1.0 / (SWEEPS + 1))


@pytest.mark.parametrize(("beyond", "said"), [(16, False), (29, False), (31, True), (58, True)])
def test_of_too_few_readings_nothing_is_said(beyond: int, said: bool) -> None:
    """Thirty beyond the parameters that are fitted tell a variance to a quarter; fewer hardly anything."""
    state = before(predictive_check, Made(points=beyond + 6))
    assert state.fit.rows - len(state.fit.free) == beyond
    assert (predictive_check(state).likeness is not None) == said
