"""What Python shows of an object at a prompt: which one it is, in a few lines, whatever it holds."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import pytest

from diagnosis.discovery.pipeline import State, discover
from diagnosis.factors.findings import quantify_many
from twin.sweep import Sweep

BENCH = Path(__file__).parents[2] / "scenarios" / "data" / "bench_sweep.csv"
LONGEST = 300
"""Characters: three lines of a terminal."""
SHOWN = {
    "sweep": "Sweep('bench_sweep.csv', 1440 readings, columns time_s, reference_deg, measured_deg",
    "motion": "Motion(1440 readings, 3.99",
    "chain": "Chain(zero, offset, gain_mismatch, phase, quadratic_nonlinearity; sensor_sense=",
    "error model": "BaselineFit(Vx_over_Ax=0.00",
    "factors": "Findings('bench_sweep.csv', BaselineFit(",
    "discovery": "Discovery('bench_sweep.csv', explained: hysteresis; held-out RMS 0.1",
    "joint fit": "Fit(Chain(zero, offset, ",
    "cause": "Finding(hysteresis; held-out RMS 0.1",
}
"""What tells an object from others of its kind."""


@functools.cache
def objects() -> dict[str, Any]:
    """What a person meets on the way from a sweep to its causes."""
    sweep = Sweep.read(BENCH)
    findings = quantify_many([sweep])[0]
    found = discover(State.of(sweep, findings.fit.chain()))
    return {
        "sweep": sweep,
        "motion": sweep.motion(),
        "chain": findings.fit.chain(),
        "error model": findings.fit,
        "factors": findings,
        "discovery": found,
        "joint fit": found.fit,
        "cause": found.causes[0],
    }


@pytest.mark.parametrize("name", SHOWN)
def test_an_object_is_shown_in_a_few_lines(name: str) -> None:
    text = repr(objects()[name])
    assert text.startswith(SHOWN[name])
    assert len(text) <= LONGEST
    assert "array(" not in text
