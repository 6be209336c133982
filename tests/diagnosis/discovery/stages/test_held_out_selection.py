"""Held-out selection: the causes of the joint fit that are proven, strongest first, each with its figures."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.proof.cross_validation import rms_deg
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.searches import with_cause
from tests.diagnosis.discovery.sweeps import Made, before

LIMIT = DiscoverySettings().footprint_log_p
SATURATION, HYSTERESIS = "saturation", "hysteresis"
BOTH = Made(causes=((SATURATION, 0.04), (HYSTERESIS, 0.1)), points=72, back=True)
ONE = Made(causes=((SATURATION, 0.08),), points=96)


@dataclass(frozen=True, kw_only=True)
class Case:
    """A sweep, a cause that the fit holds beside those that the search has found, and those that stay."""

    made: Made
    idle: str = ""
    at: dict[str, Any] = field(default_factory=dict)
    stay: tuple[str, ...] = ()


CASES = {
    "nothing found": Case(made=Made(points=72)),
    "two causes": Case(made=BOTH, stay=(SATURATION, HYSTERESIS)),
    "an idle harmonic": Case(
        made=ONE, idle="magnet_harmonic", at={"order": 5.0, "amplitude_deg": 0.01}, stay=(SATURATION,)
    ),
    "an idle bump": Case(
        made=ONE,
        idle="unnamed_bump",
        at={"centre_deg": 100.0, "width_deg": 10.0, "height_deg": 0.01},
        stay=(SATURATION,),
    ),
    "an idle slip alone": Case(made=Made(points=72), idle="index_slip", at={"step_deg": 0.01, "time_s": 12.0}),
}


def handed(case: Case) -> State:
    state = before(held_out_selection, case.made)
    return with_cause(state, case.idle, **case.at) if case.idle else state


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_what_is_proven_stays(case: Case) -> None:
    state = handed(case)
    after = held_out_selection(state)
    assert set(after.keys) == set(case.stay)
    assert [finding.keys for finding in after.findings] == [(key,) for key in after.keys]
    assert {free.key for free in after.fit.free} & set(state.keys) == set(case.stay)
    assert len(after.held) == len(case.stay) + 1
    figures = [rms_deg(held, after.fit.observations.usable) for held in after.held]
    for finding, (before_deg, after_deg) in zip(after.findings, itertools.pairwise(figures), strict=True):
        assert (finding.before_deg, finding.after_deg) == (before_deg, after_deg)
        assert after_deg < before_deg
        assert finding.family_log_p is not None
        assert finding.family_log_p < LIMIT
        # No cause is less probable among many effects than alone.
        assert finding.family_log_p >= finding.log_p
    gains = [finding.gain for finding in after.findings]
    assert gains == sorted(gains, reverse=True)


@pytest.mark.parametrize(("strength_deg", "stays"), [(0.012, False), (0.016, True)])
def test_a_cause_among_all_that_were_searched_must_be_improbable(strength_deg: float, stays: bool) -> None:
    """The family-wise probability is near the limit, on either side of it."""
    state = before(held_out_selection, Made(causes=((SATURATION, strength_deg),), points=180))
    after = held_out_selection(state if state.keys else with_cause(state, SATURATION, k_percent=0.1))
    assert after.keys == ((SATURATION,) if stays else ())


def test_what_was_found_beside_the_joint_fit_comes_after() -> None:
    state = before(held_out_selection, ONE)
    found = Finding.among(1, "stale_frames", -50.0, gain=100.0)
    after = held_out_selection(state.with_(findings=(found,)))
    assert [finding.keys for finding in after.findings] == [(SATURATION,), ("stale_frames",)]
    assert after.findings[-1] is found


def test_rivals_are_the_effects_that_fit_as_well() -> None:
    """A turn without channels leaves saturation, the magnet's fourth order and an S; channels only the last."""
    after = held_out_selection(before(held_out_selection, ONE))
    assert set(after.findings[0].rivals) == {"magnet_harmonic", "adc_inl"}
    recorded = Made(causes=((SATURATION, 0.08),), points=96, channels=True)
    assert set(held_out_selection(before(held_out_selection, recorded)).findings[0].rivals) == {"adc_inl"}


def test_the_same_generator_gives_the_same_probability() -> None:
    state = before(held_out_selection, Made(causes=((SATURATION, 0.04),), points=72))
    one, other = (
        held_out_selection(state.with_(rng=np.random.default_rng(seed))).findings[0].family_log_p for seed in (1, 2)
    )
    again = held_out_selection(state.with_(rng=np.random.default_rng(1))).findings[0].family_log_p
    assert one == again != other
