"""Control charts: run lengths against the literature and against simulation; drifts are found and named."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.factors.control_chart import WEIGHT, average_run_length, chart, deviates, limit_for
from diagnosis.factors.series import monitor
from tests.diagnosis.cases import turn
from twin.chain import Chain
from twin.motion import Motion


@pytest.mark.parametrize(
    ("weight", "widths", "shift", "expected"),
    # Lucas and Saccucci, Technometrics 32 (1990), table 3: asymptotic limits, zero state.
    [
        (0.1, 2.814, 0.0, 500.0),
        (0.25, 2.998, 0.0, 500.0),
        (0.1, 2.814, 1.0, 10.3),
        (0.2, 2.962, 1.0, 10.5),
        (0.25, 2.998, 1.0, 11.1),
    ],
)
def test_run_lengths_of_the_literature(weight: float, widths: float, shift: float, expected: float) -> None:
    limit = widths * np.sqrt(weight / (2.0 - weight))
    assert average_run_length(limit, weight, shift) == pytest.approx(expected, rel=0.02)


def test_limit_gives_the_run_length_that_was_asked_for() -> None:
    for wanted in (50.0, 500.0, 3500.0):
        assert average_run_length(limit_for(wanted)) == pytest.approx(wanted, rel=1e-6)


def test_deviates_are_standard_normal_and_independent() -> None:
    rng = np.random.default_rng(0)
    found = np.array([deviates(5.0 + 0.1 * rng.standard_normal(40))[2:] for _ in range(300)])
    # 300 series: the mean of 11,400 values scatters by 0.01, their neighbours' correlation likewise.
    assert found.mean() == pytest.approx(0.0, abs=0.04)
    assert found.std() == pytest.approx(1.0, abs=0.03)
    assert np.corrcoef(found[:, :-1].ravel(), found[:, 1:].ravel())[0, 1] == pytest.approx(0.0, abs=0.04)


def test_self_starting_chart_keeps_its_run_length() -> None:
    rng = np.random.default_rng(1)
    limit = limit_for(40.0)
    lengths = []
    for _ in range(150):
        signal = chart("x", rng.standard_normal(400), limit=limit).signal
        lengths.append((400 if signal is None else signal) - 1)
    # Run lengths are nearly exponential: the mean of 150 scatters by 40/sqrt(150) = 3.3.
    assert np.mean(lengths) == pytest.approx(40.0, abs=10.0)


@pytest.mark.parametrize("run_length", [50.0, 500.0])
def test_charts_of_a_series_share_its_run_length(run_length: float) -> None:
    """Charts that signal falsely once in L_k sweeps each do so once in 1 / sum(1 / L_k) sweeps together."""
    motion = Motion.from_angle(turn(40))
    sweeps = [Chain().with_effect("noise", rms_deg=0.02).simulate(motion, seed=k) for k in range(5)]
    charts = monitor(sweeps, rng=np.random.default_rng(0), run_length=run_length).charts
    assert len(charts) > 1
    together = 1.0 / sum(1.0 / average_run_length(one.limit) for one in charts)
    assert together == pytest.approx(run_length, rel=1e-3)


def test_drift_is_signalled_in_its_direction() -> None:
    rng = np.random.default_rng(2)
    values = rng.standard_normal(80)
    values[40:] -= 0.2 * np.arange(40)
    found = chart("x", values, limit=limit_for(3500.0))
    assert found.signal is not None
    assert 40 <= found.signal < 60
    assert found.direction == -1
    assert chart("x", np.ones(20), limit=1.0).signal is None
    assert 0.0 < WEIGHT < 1.0
