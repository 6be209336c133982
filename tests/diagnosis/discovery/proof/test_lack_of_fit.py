"""Lack of fit against repeated readings: found where it is, rarely where it is not, and told with its place."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.discovery.fitting.repeats import Repeats
from diagnosis.discovery.proof.misfit import PLACES
from diagnosis.discovery.proof.predictive_check import _Plan
from diagnosis.discovery.stages.predictive_check import predictive_check
from scenarios.commands.fail_on import in_explanation
from tests.diagnosis.discovery.sweeps import Made, before
from twin.sweep import Sweep

STOPS, READINGS, NOISE_DEG = 24, 8, 0.02


def jig(off_deg: float, *, seed: int) -> Sweep:
    """Readings repeated at each of a few angles, which are off by so much RMS each."""
    rng = np.random.default_rng(seed)
    reference = np.repeat(np.arange(STOPS) * 360.0 / STOPS, READINGS)
    measured = reference + 0.5 * np.sin(np.radians(reference)) + NOISE_DEG * rng.standard_normal(reference.size)
    measured += off_deg * np.repeat(rng.standard_normal(STOPS), READINGS)
    return Sweep.from_columns({"reference_deg": reference, "measured_deg": np.round(measured, 6) % 360.0})


def test_angles_that_are_off_are_told_with_place_and_size() -> None:
    found = explain(jig(0.1, seed=1))
    answer = found.to_dict()
    assert answer["causes"] == []
    assert answer["verdict"] == "unnamed"
    assert answer["lack_of_fit_p"] < 1e-6
    # A standard deviation of 168 degrees of freedom is known to 5 %; the highest plausible correlation adds 10 %.
    assert answer["lack_of_fit"]["by_scatter_deg"] == pytest.approx(NOISE_DEG / np.sqrt(READINGS), rel=0.25)
    assert answer["lack_of_fit"]["left_deg"] == pytest.approx(0.1, rel=0.5)
    (misfit,) = answer["misfits"]
    assert misfit["against"] == "repeated readings"
    left_deg = np.degrees(found.discovery.fit.residual[0])
    row = int(np.argmax(np.abs(left_deg)))
    assert misfit["where"] == f"most at {row * 360 // STOPS} deg"
    assert misfit["size_deg"] == pytest.approx(abs(left_deg[row]), rel=1e-5)
    assert "lies off the means of repeated readings" in " ".join(found.summary().split())
    assert "unexplained" in in_explanation(answer)


def test_nothing_off_is_adequate() -> None:
    answer = explain(jig(0.0, seed=2)).to_dict()
    assert answer["verdict"] == "adequate"
    assert answer["lack_of_fit_p"] >= 0.01
    assert answer["misfits"] == []


@pytest.mark.parametrize("correlation", [0.0, 0.5])
def test_the_variance_of_a_mean_of_correlated_readings(correlation: float) -> None:
    """That of AR(1), of which the deviations tell the correlation; not smaller, as the highest plausible one counts."""
    rng = np.random.default_rng(3)
    count, readings = 4000, 12
    white = rng.standard_normal((count, readings))
    noise = white.copy()
    for place in range(1, readings):
        noise[:, place] = correlation * noise[:, place - 1] + np.sqrt(1.0 - correlation**2) * white[:, place]
    means = noise.mean(axis=1)
    group = np.repeat(np.arange(count), readings)
    repeats = Repeats.of((noise - means[:, None]).ravel(), group)
    told = repeats.variance_of_means(np.arange(count))
    assert np.mean(means**2) * 0.9 < told[0] < np.mean(means**2) * 1.2


def test_a_mean_is_told_no_worse_than_a_single_reading() -> None:
    """Readings that repeat the one before do not hide that the stops are off."""
    steps = np.random.default_rng(4).standard_normal((20, 10)).cumsum(axis=1)
    off = steps - steps.mean(axis=1, keepdims=True)
    repeats = Repeats.of(off.ravel(), np.repeat(np.arange(20), 10))
    assert repeats.variance_of_means(np.arange(20))[0] == pytest.approx(np.sum(off**2) / (20 * 9))


def test_every_statistic_of_the_predictive_check_has_its_place() -> None:
    state = before(predictive_check, Made(causes=(("hysteresis", 0.1),), points=96))
    plan = _Plan.of(state.fit)
    names, _ = plan.statistics(np.random.default_rng(0).standard_normal((1, len(state.fit.observations))))
    conditional = {name for name in PLACES if name.endswith(("direction", "speed", "temperature", "zeros scatter"))}
    assert set(names) <= set(PLACES)
    assert set(PLACES) - conditional <= set(names)
